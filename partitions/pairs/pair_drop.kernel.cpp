#include "partitions/pairs/pair_drop.kernel.h"
#include "simd/lanes/compress.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

constexpr std::size_t kPairs = kLanes / 2;

template <bool KeepDropped>
std::size_t split(const std::uint32_t* pairs, std::size_t count, const std::uint64_t* moved,
                  std::uint32_t* kept, std::uint32_t* dropped) {
  // Little-endian: bit i of 64-bit words is bit i of 32-bit words.
  const auto* const words = reinterpret_cast<const std::uint32_t*>(moved);
  std::uint32_t* out = kept;
  std::size_t i = 0;
  for (; i + kPairs <= count; i += kPairs) {
    // Stores run over by a register at most, up to the end of what has just been read.
    const Uints ids = Uints::load_unaligned(pairs + 2 * i);
    const Mask16 hits = test_bits(words, ids);
    const Mask16 stay = ~(hits | hits >> 1U) & 0x5555U;
    const Mask16 both = stay | stay << 1U;
    if constexpr (KeepDropped) dropped += compress_store(~both & kAllRows, ids, dropped);
    out += compress_store(both, ids, out);
  }
  for (; i < count; ++i) {
    const std::uint32_t a = pairs[2 * i];
    const std::uint32_t b = pairs[2 * i + 1];
    const std::uint32_t hit = (words[a >> 5U] >> (a & 31U) | words[b >> 5U] >> (b & 31U)) & 1U;
    if constexpr (KeepDropped) {
      dropped[0] = a;
      dropped[1] = b;
      dropped += 2 * hit;
    }
    out[0] = a;
    out[1] = b;
    out += 2 * (hit ^ 1U);
  }
  return static_cast<std::size_t>(out - kept) / 2;
}

std::size_t drop(std::uint32_t* pairs, std::size_t count, const std::uint64_t* moved) {
  return split<false>(pairs, count, moved, pairs, nullptr);
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const PairDropKernels WINNOW_KERNEL_TABLE(pair_drop_kernels) = {
    WINNOW_ISA_NAME::drop, WINNOW_ISA_NAME::split<true>};

}  // namespace winnow
