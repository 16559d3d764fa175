#include "partitions/pairs/pair_tracker.h"

#include "partitions/pairs/pair_drop.kernel.h"

#include <algorithm>
#include <array>
#include <bit>

namespace winnow {

WINNOW_DEFINE_KERNELS(PairDropKernels, pair_drop_kernels)

namespace {

constexpr unsigned kDigitBits = 11;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
// For fewer pairs a comparison sort is faster than counting digits.
constexpr std::size_t kFew = 256;

// One stable pass of a radix sort: kDigitBits of member `Key` from bit `shift` on.
template <ObjectId Pair::*Key>
void pass(const Pair* from, Pair* to, std::size_t count, unsigned shift) {
  std::array<std::size_t, kDigits> start{};
  for (std::size_t i = 0; i < count; ++i) ++start[from[i].*Key >> shift & (kDigits - 1)];
  std::size_t sum = 0;
  for (std::size_t& s : start) {
    const std::size_t n = s;
    s = sum;
    sum += n;
  }
  for (std::size_t i = 0; i < count; ++i) {
    to[start[from[i].*Key >> shift & (kDigits - 1)]++] = from[i];
  }
}

}  // namespace

void PairTracker::drop(PairBuffer& out, const std::uint64_t* moved) noexcept {
  auto* const ids = reinterpret_cast<std::uint32_t*>(out.rows_.data());
  out.rows_.set_size(pair_drop_kernels().drop(ids, out.rows_.size(), moved));
}

bool PairTracker::drop(PairBuffer& out, const std::uint64_t* moved,
                       Column<Pair>& dropped) noexcept {
  // Pairs are dropped in pieces, so that `dropped` need not have room for all pairs.
  constexpr std::size_t kPiece = 4096;
  const std::size_t count = out.rows_.size();
  auto* const ids = reinterpret_cast<std::uint32_t*>(out.rows_.data());
  std::size_t kept = 0;
  for (std::size_t begin = 0; begin < count; begin += kPiece) {
    const std::size_t piece = std::min(kPiece, count - begin);
    if (!dropped.grow(dropped.size() + piece)) {
      std::copy(dropped.begin(), dropped.end(), out.rows_.begin() + kept);
      return false;
    }
    auto* const to = reinterpret_cast<std::uint32_t*>(dropped.data() + dropped.size());
    const std::size_t stayed =
        pair_drop_kernels().part(ids + 2 * begin, piece, moved, ids + 2 * kept, to);
    kept += stayed;
    dropped.set_size(dropped.size() + piece - stayed);
  }
  out.rows_.set_size(kept);
  return true;
}

bool PairTracker::sort(PairBuffer& out, std::size_t slots, std::size_t begin,
                       std::size_t end) noexcept {
  const std::size_t count = end - begin;
  if (count < kFew) {
    std::sort(out.rows_.begin() + begin, out.rows_.begin() + end);
    return true;
  }
  if (!out.pages_.reserve(count)) return false;
  const auto bits = static_cast<unsigned>(std::bit_width(slots));
  Pair* from = out.rows_.data() + begin;
  Pair* to = out.pages_.data();
  for (unsigned shift = 0; shift < bits; shift += kDigitBits) {
    pass<&Pair::second>(from, to, count, shift);
    std::swap(from, to);
  }
  for (unsigned shift = 0; shift < bits; shift += kDigitBits) {
    pass<&Pair::first>(from, to, count, shift);
    std::swap(from, to);
  }
  // Both members need the same number of passes, so the total is even and the result is in place.
  return true;
}

}  // namespace winnow
