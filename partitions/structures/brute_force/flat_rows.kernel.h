#pragma once

#include "partitions/tree/block_tree.kernel.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// Rows without a structure. If filters are in use, `blocks` contains a summary of each block's
/// filters.
struct FlatView {
  RowView rows;
  std::uint32_t row_count = 0;
  TreeView blocks{};  ///< without boxes; no levels if filters are not in use
};

/// Kernels that test every row against every row, for one kind of volume.
struct FlatKernel {
  /// Finds all pairs whose first row is in blocks [begin, end).
  bool (*self_pairs)(const FlatView&, std::uint32_t begin, std::uint32_t end, PairSink&);
  /// Finds all hits of the batch, which contains volumes of this kind.
  bool (*query)(const FlatView&, const QueryBatch&, PairSink&);
};

struct FlatKernels {
  FlatKernel untested;  ///< every pair is a hit
  FlatKernel aabb;
  FlatKernel sphere;
  FlatKernel kdop14;
  FlatKernel kdop18;
  FlatKernel kdop26;
};

WINNOW_KERNELS(FlatKernels, flat_kernels);

}  // namespace winnow
