#include <winnow/partitions/pair_tracker.h>

#include <winnow/partitions/pair_drop.kernel.h>

#include <array>
#include <bit>

namespace winnow {

WINNOW_DEFINE_KERNELS(PairDropKernels, pair_drop_kernels)

namespace {

constexpr unsigned kDigitBits = 11;
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;

// One stable pass of a radix sort by `kDigitBits` of member `Key` from `shift` on.
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
  auto* const ids = reinterpret_cast<std::uint32_t*>(out.pairs_.data());
  out.pairs_.set_size(pair_drop_kernels().drop(ids, out.pairs_.size(), moved));
}

bool PairTracker::sort(PairBuffer& out, std::size_t slots) noexcept {
  const std::size_t count = out.pairs_.size();
  if (!out.pages_.reserve(count)) return false;
  const auto bits = static_cast<unsigned>(std::bit_width(slots));
  Pair* from = out.pairs_.data();
  Pair* to = out.pages_.data();
  for (unsigned shift = 0; shift < bits; shift += kDigitBits) {
    pass<&Pair::second>(from, to, count, shift);
    std::swap(from, to);
  }
  for (unsigned shift = 0; shift < bits; shift += kDigitBits) {
    pass<&Pair::first>(from, to, count, shift);
    std::swap(from, to);
  }
  // As many passes for each member: an even number, so the result stands where it began.
  return true;
}

}  // namespace winnow
