#pragma once

#include "partitions/rows/row_view.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// One more than a 16-ary tree over 2^28 blocks has.
inline constexpr std::uint32_t kMaxTreeLevels = 8;

/// Summaries of the filters of objects below the nodes of one level; all null if no filter was ever
/// set. An object of every environment counts as having first environment 0 and last environment
/// ~0.
struct NodeFilters {
  std::uint32_t* layers = nullptr;  ///< union
  std::uint32_t* mask = nullptr;    ///< union
  std::uint32_t* first_environment = nullptr;
  std::uint32_t* last_environment = nullptr;
  std::uint32_t* alike = nullptr;  ///< 1 if all objects have the same filter
  // Intersections; 0 if an object is in no layer or has an empty mask.
  std::uint32_t* every_layers = nullptr;
  std::uint32_t* every_mask = nullptr;
};

/// An implicit 16-ary tree: node i of level l + 1 bounds nodes [16 i, 16 i + 16) of level l, and
/// node i of level 0 bounds the rows of block first_block + i. Level arrays are padded to 16 with
/// empty boxes. The top level has at most 16 nodes.
struct TreeShape {
  std::uint32_t first_block = 0;
  std::uint16_t levels = 0;   ///< 0 if there are no blocks
  bool environments = false;  ///< more than one environment is in use
  std::uint32_t count[kMaxTreeLevels] = {};
  float* node[kMaxTreeLevels][6] = {};
  NodeFilters filters[kMaxTreeLevels];
};

/// A tree and the rows below it.
struct TreeView : TreeShape {
  RowView rows;
};

struct BlockTreeKernels {
  /// Recomputes nodes [begin, end) of level 0 from the rows.
  void (*refit_leaves)(const TreeView&, std::uint32_t begin, std::uint32_t end);
  /// Recomputes nodes [begin, end) of `level` > 0 from the level below.
  void (*refit_nodes)(const TreeView&, std::uint32_t level, std::uint32_t begin, std::uint32_t end);
  /// Finds all pairs whose first row is in groups [begin, end) of 16 blocks, with rows in the same
  /// and later blocks. Returns false if the sink could not grow.
  bool (*self_pairs)(const TreeView&, std::uint32_t begin, std::uint32_t end, PairSink&);
  /// Finds all hits of the batch's boxes. Returns false if the sink could not grow.
  bool (*query)(const TreeView&, const QueryBatch&, PairSink&);
};

WINNOW_KERNELS(BlockTreeKernels, block_tree_kernels);

}  // namespace winnow
