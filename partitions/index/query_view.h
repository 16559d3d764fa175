#pragma once

#include <winnow/core/object_filter.h>
#include "core/memory/filter_columns.h"
#include "partitions/rows/filter_span.h"
#include "partitions/tree/block_tree.kernel.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// How queries see a partition: boxes in rows, and what leads to them. Every row lies either in a
/// block of one of the trees or in the flat blocks, which are all looked at.
struct QueryView {
  /// Of the boxes: lower ends, then upper ends. Each query fills in all of them.
  const float* column[6];
  const std::uint32_t* id = nullptr;
  FilterColumns filter;  ///< by row
  FilterSpan span;       ///< of all objects' filters
  const TreeShape* tree[2] = {};
  std::uint32_t trees = 0;
  std::uint32_t flat_blocks = 0;
  float leaf_edge = 0.0F;  ///< of a typical block; 0 if there are no trees
};

/// Whom a query wants.
struct QueryFilter {
  ObjectFilter object;
  bool by_object = false;  ///< false: `object` meets every object there is
  bool (*accept)(const void* context, std::uint32_t id) = nullptr;  ///< null: all
  const void* context = nullptr;
};

/// Where kernels write object ids: while cursor <= limit there is room for 16.
struct IdSink {
  std::uint32_t* cursor = nullptr;
  std::uint32_t* limit = nullptr;
  bool (*grow)(IdSink& sink) = nullptr;
  void* owner = nullptr;
};

}  // namespace winnow
