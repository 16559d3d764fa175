#include "partitions/pairs/pair_drop.kernel.h"

#include <cstring>

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Returns an integer whose lowest bit is bit i.
std::uint64_t from_bit(const std::uint64_t* bits, std::uint32_t i) {
  return bits[i >> 6U] >> (i & 63U);
}

/// Scalar code, because a gather of bits is not faster. The file is a kernel because wider
/// instruction sets have faster shifts by a variable number of bits.
template <bool KeepDropped>
std::size_t split(const std::uint32_t* pairs, std::size_t count, const std::uint64_t* moved,
                  std::uint32_t* kept, std::uint32_t* dropped) {
  std::uint32_t* out = kept;
  for (std::size_t i = 0; i < count; ++i) {
    // Load both ids as one integer, which compilers do not split. Their order does not matter.
    std::uint64_t pair;
    std::memcpy(&pair, pairs + 2 * i, sizeof pair);
    const auto a = static_cast<std::uint32_t>(pair);
    const auto b = static_cast<std::uint32_t>(pair >> 32U);
    // Branchless: the set of moved objects is unpredictable.
    const std::size_t hit = (from_bit(moved, a) | from_bit(moved, b)) & 1U;
    if constexpr (KeepDropped) {
      std::memcpy(dropped, &pair, sizeof pair);
      dropped += 2 * hit;
    }
    std::memcpy(out, &pair, sizeof pair);
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
