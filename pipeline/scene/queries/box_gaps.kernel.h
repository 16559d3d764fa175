#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>

namespace winnow {

/// `squared`: out[i] is the squared distance of box i of `count` from the box [low, high], rounded
/// after each operation, and limited to the range of float. `bounds` are the columns of the boxes,
/// lower bounds before upper ones. All columns are aligned and padded to sixteen elements; bounds
/// may be infinite.
struct BoxGapsKernels {
  void (*squared)(const float* const* bounds, std::size_t count, const float* low,
                  const float* high, float* out);
};

WINNOW_KERNELS(BoxGapsKernels, box_gaps_kernels);

}  // namespace winnow
