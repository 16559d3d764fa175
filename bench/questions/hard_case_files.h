#pragma once

#include <span>

namespace winnow::bench {

/// A file of tests/hard_cases, compiled in so that the tool can be moved.
struct HardCaseFile {
  const char* family;
  const char* json;
};

/// All of them by name; none where the tool was built without the tests.
[[nodiscard]] std::span<const HardCaseFile> hard_case_files() noexcept;

}  // namespace winnow::bench
