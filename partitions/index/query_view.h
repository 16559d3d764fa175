#pragma once

#include <winnow/core/filter.h>
#include "core/memory/filter_columns.h"
#include "partitions/rows/filter_span.h"
#include "partitions/tree/block_tree.kernel.h"

#include <cstdint>

namespace winnow {

/// The rows of a partition as queries see them. Every row is either in a block of one of the trees
/// or in a flat block; flat blocks are all tested. If there are regular rows in no flat block,
/// tree[0] is theirs.
struct QueryView {
  const float* column[6] = {};  ///< lower bounds x, y, z, then upper bounds
  const std::uint32_t* id = nullptr;
  FilterColumns filter;  ///< by row
  FilterSpan span;       ///< summary of the filters of all objects
  const TreeShape* tree[2] = {};
  std::uint32_t trees = 0;
  std::uint32_t flat_blocks = 0;
  float leaf_edge = 0.0F;  ///< edge of a typical block; 0 if there are no trees
};

/// Selects the objects that a query returns.
struct QueryFilter {
  ObjectFilter object;
  bool by_object = false;  ///< false: `object` accepts all objects
  bool (*accept)(const void* context, std::uint32_t id) = nullptr;  ///< null: accepts all
  const void* context = nullptr;
};

/// Output of kernels: while cursor <= limit there is room for 16 more object ids; after that,
/// kernels call `grow`.
struct IdSink {
  std::uint32_t* cursor = nullptr;
  std::uint32_t* limit = nullptr;
  bool (*grow)(IdSink& sink) = nullptr;
  void* owner = nullptr;
};

}  // namespace winnow
