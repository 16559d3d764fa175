#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

struct PairDropKernels {
  /// Removes, in place and in stable order, every pair with an id whose bit is set in `moved`;
  /// returns the number of remaining pairs.
  std::size_t (*drop)(std::uint32_t* pairs, std::size_t count, const std::uint64_t* moved);
  /// As above, but writes remaining pairs to `kept`, which may be `pairs` or begin before it, and
  /// removed pairs to `dropped`, which has room for all pairs.
  std::size_t (*part)(const std::uint32_t* pairs, std::size_t count, const std::uint64_t* moved,
                      std::uint32_t* kept, std::uint32_t* dropped);
};

WINNOW_KERNELS(PairDropKernels, pair_drop_kernels);

}  // namespace winnow
