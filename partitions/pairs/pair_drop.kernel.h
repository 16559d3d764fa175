#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

struct PairDropKernels {
  /// Drops, in place and keeping the order, every pair of ids of which one has its bit set in
  /// `moved`; returns how many pairs are left.
  std::size_t (*drop)(std::uint32_t* pairs, std::size_t count, const std::uint64_t* moved);
  /// The same, writing the pairs that stay to `kept`, which may be where `pairs` begin or before,
  /// and the others to `dropped`, which has room for all.
  std::size_t (*part)(const std::uint32_t* pairs, std::size_t count, const std::uint64_t* moved,
                      std::uint32_t* kept, std::uint32_t* dropped);
};

WINNOW_KERNELS(PairDropKernels, pair_drop_kernels);

}  // namespace winnow
