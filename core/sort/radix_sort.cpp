#include "core/sort/radix_sort.h"

#include <algorithm>
#include <array>

namespace winnow {
namespace {

constexpr unsigned kDigitBits = 11;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
constexpr std::size_t kMaxChunks = 8;
constexpr std::size_t kItemsPerChunk = 16384;

using Histogram = std::array<std::uint32_t, kDigits>;

std::size_t digit(std::uint64_t item, unsigned shift) {
  return static_cast<std::size_t>(item >> shift) & (kDigits - 1);
}

// One pass: every chunk counts its digits, starts are summed digit by digit and chunk by chunk, so
// that chunks scatter to where a serial pass would have put their items.
void pass(const std::uint64_t* from, std::uint64_t* to, std::size_t count, unsigned shift,
          std::size_t chunks, const Execution& execution) {
  std::array<Histogram, kMaxChunks> start;
  const auto begin_of = [&](std::size_t chunk) { return count * chunk / chunks; };
  execution.for_each(chunks, [&](std::size_t chunk) {
    start[chunk].fill(0);
    for (std::size_t i = begin_of(chunk); i < begin_of(chunk + 1); ++i) {
      ++start[chunk][digit(from[i], shift)];
    }
  });
  std::uint32_t sum = 0;
  for (std::size_t d = 0; d < kDigits; ++d) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
      const std::uint32_t n = start[chunk][d];
      start[chunk][d] = sum;
      sum += n;
    }
  }
  execution.for_each(chunks, [&](std::size_t chunk) {
    Histogram& at = start[chunk];
    for (std::size_t i = begin_of(chunk); i < begin_of(chunk + 1); ++i) {
      to[at[digit(from[i], shift)]++] = from[i];
    }
  });
}

}  // namespace

std::uint64_t* radix_sort(std::uint64_t* items, std::uint64_t* spare, std::size_t count,
                          unsigned bits, const Execution& execution, unsigned first_bit) noexcept {
  const bool share = execution.concurrency() > 1 && count >= 2 * kItemsPerChunk;
  const std::size_t chunks =
      share ? std::min({kMaxChunks, count / kItemsPerChunk, execution.concurrency()}) : 1;
  for (unsigned shift = 0; shift < bits; shift += kDigitBits) {
    pass(items, spare, count, first_bit + shift, chunks, execution);
    std::swap(items, spare);
  }
  return items;
}

}  // namespace winnow
