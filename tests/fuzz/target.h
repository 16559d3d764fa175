#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace winnow::test {

// Every target defines fuzz() and fuzz_seeds().

/// Makes the calls that the bytes encode, and ends the process if a check fails.
void fuzz(std::span<const std::uint8_t> bytes);
/// Returns the inputs to begin with; equal each time.
[[nodiscard]] std::vector<std::string> fuzz_seeds();

/// Returns `count` random strings of at most this length.
[[nodiscard]] std::vector<std::string> random_seeds(std::size_t count, std::size_t length);

/// A temporary file with these bytes; the destructor removes it.
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

/// Ends the process so that the fuzzer saves the input.
[[noreturn]] void does_not_hold(const char* file, int line, const std::string& what);

}  // namespace winnow::test

/// Checks a bool or a testing::AssertionResult.
#define WINNOW_REQUIRE(...)                                                           \
  do {                                                                                \
    if (const testing::AssertionResult held(__VA_ARGS__); !held) {                    \
      winnow::test::does_not_hold(__FILE__, __LINE__,                                 \
                                  std::string(#__VA_ARGS__) + ": " + held.message()); \
    }                                                                                 \
  } while (false)
