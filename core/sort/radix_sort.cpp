#include "core/sort/radix_sort.h"

#include <algorithm>
#include <array>

namespace winnow {
namespace {

constexpr unsigned kMostDigitBits = 11;
constexpr std::size_t kMostDigits = std::size_t{1} << kMostDigitBits;
constexpr std::size_t kMaxChunks = 8;
constexpr std::size_t kItemsPerChunk = 4096;

using Histogram = std::array<std::uint32_t, kMostDigits>;

struct Digit {
  unsigned shift;
  std::size_t values;

  [[nodiscard]] std::size_t of(std::uint64_t item) const {
    return static_cast<std::size_t>(item >> shift) & (values - 1);
  }
};

// One pass: every chunk counts its digits, starts are summed digit by digit and chunk by chunk, so
// that chunks scatter to where a serial pass would have put their items.
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

}  // namespace

std::uint64_t* radix_sort(std::uint64_t* items, std::uint64_t* spare, std::size_t count,
                          unsigned bits, const Execution& execution, unsigned first_bit) noexcept {
  const bool share = execution.concurrency() > 1 && count >= 2 * kItemsPerChunk;
  const std::size_t chunks =
      share ? std::min({kMaxChunks, count / kItemsPerChunk, execution.concurrency()}) : 1;
  // Digits of one length: the fewer buckets, the more of their ends are in the cache.
  const unsigned passes = (bits + kMostDigitBits - 1) / kMostDigitBits;
  const unsigned length = passes == 0 ? 0 : (bits + passes - 1) / passes;
  for (unsigned shift = 0; shift < bits; shift += length) {
    const Digit digit{first_bit + shift, std::size_t{1} << std::min(length, bits - shift)};
    pass(items, spare, count, digit, chunks, execution);
    std::swap(items, spare);
  }
  return items;
}

}  // namespace winnow
