#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace winnow::test {

// What each fuzzed target defines.

/// Does what the bytes say and ends the process if something does not hold.
void fuzz(std::span<const std::uint8_t> bytes);
/// Inputs to begin with; the same each time.
[[nodiscard]] std::vector<std::string> fuzz_seeds();

/// So many strings of random bytes, up to a length.
[[nodiscard]] std::vector<std::string> random_seeds(std::size_t count, std::size_t length);

/// A file of these bytes that is gone when this is.
class ScratchFile {
 public:
  ScratchFile(std::span<const std::uint8_t> bytes, const std::string& ending);
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Ends the process so that a fuzzer keeps the input.
[[noreturn]] void does_not_hold(const char* file, int line, const std::string& what);

}  // namespace winnow::test

/// Of a bool or a testing::AssertionResult.
#define WINNOW_HOLDS(...)                                                             \
  do {                                                                                \
    if (const testing::AssertionResult held(__VA_ARGS__); !held) {                    \
      winnow::test::does_not_hold(__FILE__, __LINE__,                                 \
                                  std::string(#__VA_ARGS__) + ": " + held.message()); \
    }                                                                                 \
  } while (false)
