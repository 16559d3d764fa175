#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>

namespace winnow {

/// `squared`: out[i] is the square of how far box i of `count` is from [low, high], each of the few
/// operations rounded, or what floats hold of it if that is too much. `bounds` are the columns of
/// the boxes, lower bounds before upper ones; all columns are aligned to and padded to sixteen, and
/// bounds may be infinite.
struct BoxGapsKernels {
  void (*squared)(const float* const* bounds, std::size_t count, const float* low,
                  const float* high, float* out);
};

WINNOW_KERNELS(BoxGapsKernels, box_gaps_kernels);

}  // namespace winnow
