#pragma once

#include <winnow/core/column.h>
#include <winnow/core/debug_draw.h>
#include "partitions/rows/rows.h"
#include "partitions/structures/cells/cell_layout.h"

#include <cstdint>
#include <string_view>

namespace winnow {

/// Draws every cell that holds an object, the box around what it holds, and an arrow along axis 0
/// with its name and `meaning`. Cell c holds rows [start[c], start[c + 1]).
///
/// A cell is drawn where it would be if every object lay still: in truth it reaches a little
/// further (see CellAxis), and the first and last of an axis without end. An axis that is not
/// divided is drawn as long as the bounded part of what lies in the cells.
void draw_cells(DebugDraw& draw, const CellLayout& layout, const RowView& rows,
                const Column<std::uint32_t>& start, std::string_view meaning);

}  // namespace winnow
