#pragma once

#include <winnow/core/memory.h>
#include "partitions/tree/block_tree.kernel.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Node arrays are padded to a block.
[[nodiscard]] constexpr std::size_t padded_nodes(std::size_t nodes) noexcept {
  return (nodes + 15) / 16 * 16;
}

/// Allocates the NodeFilters of every level of a tree in `memory`, padded with nodes that match no
/// filter. Returns false if an allocation fails.
[[nodiscard]] bool lay_out_filters(TreeShape& shape, Column<std::uint32_t>& memory) noexcept;

/// Makes nodes [begin, end) match no filter.
void empty_filters(const NodeFilters& nodes, std::uint32_t begin, std::uint32_t end) noexcept;

/// Recomputes the filters of nodes [begin, end) of level 0 from the rows.
void refit_leaf_filters(const TreeView& tree, std::uint32_t begin, std::uint32_t end) noexcept;

/// Recomputes the filters of nodes [begin, end) of `level` > 0 from the level below.
void refit_node_filters(const TreeView& tree, std::uint32_t level, std::uint32_t begin,
                        std::uint32_t end) noexcept;

}  // namespace winnow
