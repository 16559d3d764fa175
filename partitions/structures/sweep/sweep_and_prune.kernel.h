#pragma once

#include "partitions/rows/row_view.h"
#include "partitions/structures/cells/cell_axis.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// Rows in strips: strip s holds rows [start[s], start[s + 1]), sorted by `key`, which was the
/// lower end of the box on the sweep axis when the strip was built. The end may have drifted from
/// its key by `drift` since.
struct StripView {
  RowView rows;
  const float* key = nullptr;
  const std::uint32_t* start = nullptr;
  CellAxis axis[3];  ///< 0 is the sweep axis, of one cell; strips lie on the other two
  float drift = 0.0F;
};

struct SweepKernels {
  /// All pairs whose earlier strip lies in [begin, end), or whose first row does within a strip.
  bool (*self_pairs)(const StripView&, std::uint32_t begin, std::uint32_t end, PairSink&);
  /// All hits of the batch's boxes.
  bool (*query)(const StripView&, const QueryBatch&, PairSink&);
  /// Writes to `out` the rows of strips [begin, end) that left their strip or drifted too far;
  /// returns how many.
  std::uint32_t (*find_misfits)(const StripView&, std::uint32_t begin, std::uint32_t end,
                                std::uint32_t* out);
};

WINNOW_KERNELS(SweepKernels, sweep_kernels);

}  // namespace winnow
