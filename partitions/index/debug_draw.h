#pragma once

#include <winnow/core/debug_draw.h>
#include "partitions/index/spatial_index.h"
#include "partitions/rows/rows.h"

#include <cstddef>

namespace winnow {

/// Draws the structure, and the tree down to `max_depth` levels below the root.
void draw_structure(DebugDraw& draw, const Rows& rows, const SpatialIndex& index,
                    std::size_t max_depth);
void draw_objects(DebugDraw& draw, const Rows& rows, const DebugDrawOptions& options);

}  // namespace winnow
