#include "core/sort/radix_sort.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace winnow {
namespace {

// Long digits need fewer passes; with short digits the ends of all buckets stay in the cache.
// Threads synchronise after each pass, so a parallel sort uses long digits.
constexpr unsigned kMaxDigitBits = 11;
constexpr unsigned kShortDigitBits = 9;
constexpr std::size_t kMaxDigits = std::size_t{1} << kMaxDigitBits;
constexpr std::size_t kMaxChunks = 8;
constexpr std::size_t kItemsPerChunk = 4096;

using Histogram = std::array<std::uint32_t, kMaxDigits>;

struct Digit {
  unsigned shift;
  std::size_t values;

  [[nodiscard]] std::size_t of(std::uint64_t item) const {
    return static_cast<std::size_t>(item >> shift) & (values - 1);
  }
};

// One pass in parallel. Every chunk counts its digits; starts are summed digit by digit and chunk
// by chunk, so that the chunks scatter items to the same positions as a serial pass.
void pass(const std::uint64_t* from, std::uint64_t* to, std::size_t count, const Digit& digit,
          std::size_t chunks, const Execution& execution) {
  std::array<Histogram, kMaxChunks> start;
  const auto begin_of = [&](std::size_t chunk) { return count * chunk / chunks; };
  execution.for_each(chunks, [&](std::size_t chunk) {
    std::fill_n(start[chunk].begin(), digit.values, 0U);
    for (std::size_t i = begin_of(chunk); i < begin_of(chunk + 1); ++i) {
      ++start[chunk][digit.of(from[i])];
    }
  });
  std::uint32_t sum = 0;
  for (std::size_t d = 0; d < digit.values; ++d) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
      const std::uint32_t n = start[chunk][d];
      start[chunk][d] = sum;
      sum += n;
    }
  }
  execution.for_each(chunks, [&](std::size_t chunk) {
    Histogram& at = start[chunk];
    for (std::size_t i = begin_of(chunk); i < begin_of(chunk + 1); ++i) {
      to[at[digit.of(from[i])]++] = from[i];
    }
  });
}

/// Digits of equal length, at most `most` bits, that a key is divided into.
struct Digits {
  unsigned passes;
  unsigned length;

  Digits(unsigned bits, unsigned most)
      : passes((bits + most - 1) / most), length(passes == 0 ? 0 : (bits + passes - 1) / passes) {}
};

// Runs all passes on one thread; one scan counts the digits of all passes.
std::uint64_t* sort_serially(std::uint64_t* items, std::uint64_t* spare, std::size_t count,
                             unsigned bits, unsigned first_bit) {
  constexpr std::size_t kMaxPasses = (64 + kShortDigitBits - 1) / kShortDigitBits;
  std::array<std::array<std::uint32_t, std::size_t{1} << kShortDigitBits>, kMaxPasses> start;
  const Digits digits(bits, kShortDigitBits);
  if (count == 0 || digits.passes == 0) return items;
  const std::size_t values = std::size_t{1} << digits.length;
  for (unsigned p = 0; p < digits.passes; ++p) std::fill_n(start[p].begin(), values, 0U);
  const std::uint64_t whole = ~std::uint64_t{0} >> (64 - bits);
  const auto digit_of = [&](std::uint64_t item, unsigned p) {
    return static_cast<std::size_t>((item >> first_bit & whole) >> (p * digits.length)) &
           (values - 1);
  };
  for (std::size_t i = 0; i < count; ++i) {
    for (unsigned p = 0; p < digits.passes; ++p) ++start[p][digit_of(items[i], p)];
  }
  for (unsigned p = 0; p < digits.passes; ++p) {
    auto& at = start[p];
    if (at[digit_of(items[0], p)] == count) continue;
    std::exclusive_scan(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(values), at.begin(),
                        0U);
    for (std::size_t i = 0; i < count; ++i) spare[at[digit_of(items[i], p)]++] = items[i];
    std::swap(items, spare);
  }
  return items;
}

}  // namespace

std::uint64_t* radix_sort(std::uint64_t* items, std::uint64_t* spare, std::size_t count,
                          unsigned bits, const Execution& execution, unsigned first_bit) noexcept {
  const std::size_t chunks =
      std::min({kMaxChunks, count / kItemsPerChunk, execution.concurrency()});
  if (chunks <= 1) return sort_serially(items, spare, count, bits, first_bit);
  const Digits digits(bits, kMaxDigitBits);
  for (unsigned shift = 0; shift < bits; shift += digits.length) {
    const Digit digit{first_bit + shift, std::size_t{1} << std::min(digits.length, bits - shift)};
    pass(items, spare, count, digit, chunks, execution);
    std::swap(items, spare);
  }
  return items;
}

}  // namespace winnow
