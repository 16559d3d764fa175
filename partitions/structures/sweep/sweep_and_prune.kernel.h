#pragma once

#include "partitions/structures/cells/cells.kernel.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// Rows in strips: strip s contains rows [start[s], start[s + 1]), sorted by `key`, the lower bound
/// of the box on the sweep axis when the strip was built. The lower bound may have drifted from the
/// key by at most `drift` since.
struct StripView {
  RowView rows;
  const float* key = nullptr;
  const std::uint32_t* start = nullptr;
  CellAxis axis[3];  ///< 0 is the sweep axis, with one cell; strips divide the other two
  float drift = 0.0F;
};

/// Places and units are strips.
using SweepKernels = CellKernels<StripView>;

WINNOW_KERNELS(SweepKernels, sweep_kernels);

}  // namespace winnow
