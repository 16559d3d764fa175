#pragma once

#include "partitions/rows/rows.h"
#include "partitions/tree/block_tree.h"

#include <cstddef>

namespace winnow {

// All functions require that there are no regular rows: then block i of the tree is block i of the
// rows.

/// Counts the blocks in the order of the last build that are wide compared with `edge`, the edge of
/// a typical block after the build.
[[nodiscard]] std::size_t count_wide_blocks(const Rows& rows, const BlockTree& tree,
                                            float edge) noexcept;

/// Returns the number of full blocks in the order of the last build.
[[nodiscard]] std::size_t ordered_blocks(const Rows& rows, const BlockTree& tree) noexcept;

/// Selects outliers: objects that jumped away from the other objects in their block of the tree.
/// Stops at the block with which there are at least `limit`. Returns false if an allocation fails.
[[nodiscard]] bool select_outliers(const Rows& rows, const BlockTree& tree, float edge,
                                   std::size_t limit) noexcept;

}  // namespace winnow
