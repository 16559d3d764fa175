#pragma once

#include <winnow/core/debug_draw.h>
#include <winnow/core/memory.h>
#include "partitions/rows/rows.h"
#include "partitions/structures/cells/cell_layout.h"

#include <cstdint>
#include <string_view>

namespace winnow {

/// Draws every cell that contains an object, the bounds of its contents, and an arrow along axis 0
/// with the axis name and `meaning`. Cell c contains rows [start[c], start[c + 1]).
///
/// Cells are drawn without their slack (see CellAxis); the first and last cell of an axis are drawn
/// bounded although they are unbounded. An axis that is not divided is drawn as long as the bounded
/// part of the contents.
void draw_cells(DebugDraw& draw, const CellLayout& layout, const RowView& rows,
                const Column<std::uint32_t>& start, std::string_view meaning);

}  // namespace winnow
