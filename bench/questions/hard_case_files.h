#pragma once

#include <span>

namespace winnow::bench {

/// A file of tests/hard_cases, compiled in so that the tool does not need the source tree.
struct HardCaseFile {
  const char* family;
  const char* json;
};

/// Returns all files sorted by name, or none if the tool was built without the tests.
[[nodiscard]] std::span<const HardCaseFile> hard_case_files() noexcept;

}  // namespace winnow::bench
