// BlockTree: memory layout, refit and sampling of the nodes. The kernels are in
// block_tree.kernel.cpp, the nodes' filters in node_filters.cpp.

#include "partitions/tree/block_tree.h"

#include "core/memory/columns.h"

#include <algorithm>
#include <limits>

namespace winnow {

WINNOW_DEFINE_KERNELS(BlockTreeKernels, block_tree_kernels)

namespace {

constexpr std::size_t kLeavesPerTask = 1024;

// Levels of nodes over `blocks` blocks.
TreeShape levels_over(std::size_t blocks) noexcept {
  TreeShape shape;
  if (blocks == 0) return shape;
  std::size_t count = blocks;
  for (;;) {
    shape.count[shape.levels++] = static_cast<std::uint32_t>(count);
    if (count <= 16) return shape;
    count = (count + 15) / 16;
  }
}

// The number of floats in the boxes of all nodes.
std::size_t floats_of(const TreeShape& shape) noexcept {
  std::size_t total = 0;
  for (std::uint32_t level = 0; level < shape.levels; ++level) {
    total += 6 * padded_nodes(shape.count[level]);
  }
  return total;
}

// Returns the number of blocks that a tree over `blocks` blocks has room for: a sixteenth more, up
// to the size that needs another level. The result is monotonic in `blocks`.
std::size_t blocks_with_room(std::size_t blocks) noexcept {
  const std::size_t most = std::size_t{1} << (4 * levels_over(blocks).levels);
  return std::min(blocks + blocks / 16, most);
}

// Makes nodes [begin, end) of a level empty.
void empty_boxes(const TreeShape& shape, std::uint32_t level, std::uint32_t begin,
                 std::uint32_t end) noexcept {
  constexpr float inf = std::numeric_limits<float>::infinity();
  for (std::size_t c = 0; c < 6 && begin < end; ++c) {
    std::fill(shape.node[level][c] + begin, shape.node[level][c] + end, c < 3 ? inf : -inf);
  }
}
void empty_nodes(const TreeShape& shape, std::uint32_t level, std::uint32_t begin,
                 std::uint32_t end) noexcept {
  if (shape.node[level][0] != nullptr) empty_boxes(shape, level, begin, end);
  if (shape.filters[level].layers != nullptr) empty_filters(shape.filters[level], begin, end);
}

}  // namespace

bool BlockTree::cover(std::size_t first_block, std::size_t blocks, NodeContent nodes) noexcept {
  filters_of_ = 0;
  laid_out_ = static_cast<std::uint32_t>(blocks_with_room(blocks));
  TreeShape shape = levels_over(laid_out_);
  shape.first_block = static_cast<std::uint32_t>(first_block);
  shape_.clear();
  // Node values are recomputed, so no values have to be copied into larger memory.
  nodes_.clear();
  filters_.clear();
  if (first_block == 0 && blocks == 0) return true;
  return (nodes == NodeContent::filters || lay_boxes(shape)) &&
         (nodes == NodeContent::boxes || lay_out_filters(shape, filters_)) &&
         shape_.push_back(shape) && (blocks == 0 || try_resize(blocks));
}

bool BlockTree::try_resize(std::size_t blocks) noexcept {
  if (shape_.empty() || blocks == 0) return false;
  TreeShape& shape = shape_[0];
  const TreeShape new_shape = levels_over(blocks);
  const TreeShape room = levels_over(laid_out_);
  if (new_shape.levels != room.levels) return false;
  for (std::uint32_t level = 0; level < room.levels; ++level) {
    if (new_shape.count[level] > padded_nodes(room.count[level])) return false;
  }
  for (std::uint32_t level = 0; level < room.levels; ++level) {
    empty_nodes(shape, level, new_shape.count[level], shape.count[level]);
    shape.count[level] = new_shape.count[level];
  }
  return true;
}

bool BlockTree::reserve(std::size_t blocks, Pages pages) noexcept {
  const std::size_t floats = floats_of(levels_over(blocks_with_room(blocks)));
  if (!shape_.reserve(1) || !nodes_.reserve(floats, pages)) return false;
  // Existing nodes may have moved.
  if (!nodes_.empty() && !shape_.empty()) set_box_pointers(shape_[0]);
  return true;
}

bool BlockTree::lay_boxes(TreeShape& shape) noexcept {
  const std::size_t total = floats_of(shape);
  if (!nodes_.grow(total)) return false;
  nodes_.set_size(total);
  set_box_pointers(shape);
  return true;
}

// Sets the pointers of the shape to its nodes, and empties the nodes behind them.
void BlockTree::set_box_pointers(TreeShape& shape) noexcept {
  const TreeShape room = levels_over(laid_out_);
  float* at = nodes_.data();
  for (std::uint32_t level = 0; level < shape.levels; ++level) {
    const std::size_t stride = padded_nodes(room.count[level]);
    for (std::size_t c = 0; c < 6; ++c) {
      shape.node[level][c] = at;
      at += stride;
    }
    empty_boxes(shape, level, shape.count[level], static_cast<std::uint32_t>(stride));
  }
}

TreeView BlockTree::view(const RowView& rows) const noexcept {
  return {shape(), rows};
}

void BlockTree::refit_all(const RowView& rows, const Execution& execution) noexcept {
  if (has_filters()) shape_[0].environments = rows.environments;
  const TreeView tree = view(rows);
  const BlockTreeKernels& kernels = block_tree_kernels();
  const bool filters = has_filters() && filters_of_ != rows.arrangement;
  const std::size_t tasks = (blocks() + kLeavesPerTask - 1) / kLeavesPerTask;
  execution.for_each(tasks, [&](std::size_t task) {
    const std::size_t begin = task * kLeavesPerTask;
    const std::size_t end = std::min(blocks(), begin + kLeavesPerTask);
    const auto first = static_cast<std::uint32_t>(begin);
    const auto last = static_cast<std::uint32_t>(end);
    if (!nodes_.empty()) kernels.refit_leaves(tree, first, last);
    if (filters) refit_leaf_filters(tree, first, last);
  });
  for (std::uint32_t level = 1; level < tree.levels; ++level) {
    if (!nodes_.empty()) kernels.refit_nodes(tree, level, 0, tree.count[level]);
    if (filters) refit_node_filters(tree, level, 0, tree.count[level]);
  }
  filters_of_ = rows.arrangement;
}

void BlockTree::refit(const RowView& rows, std::span<std::uint32_t> leaves) noexcept {
  if (has_filters()) shape_[0].environments = rows.environments;
  const TreeView tree = view(rows);
  const BlockTreeKernels& kernels = block_tree_kernels();
  const bool filters = has_filters() && filters_of_ != rows.arrangement;
  for (const std::uint32_t leaf : leaves) {
    if (!nodes_.empty()) kernels.refit_leaves(tree, leaf, leaf + 1);
    if (filters) refit_leaf_filters(tree, leaf, leaf + 1);
  }
  for (std::uint32_t level = 1; level < tree.levels; ++level) {
    for (std::uint32_t& node : leaves) node /= 16;
    leaves = {leaves.begin(), std::unique(leaves.begin(), leaves.end())};
    for (const std::uint32_t node : leaves) {
      if (!nodes_.empty()) kernels.refit_nodes(tree, level, node, node + 1);
      if (filters) refit_node_filters(tree, level, node, node + 1);
    }
  }
  filters_of_ = rows.arrangement;
}

float BlockTree::typical_edge() const noexcept {
  return median_edge(blocks(), [&](std::size_t leaf, std::size_t a) {
    const float* const* const ends = shape().node[0];
    return ends[3 + a][leaf] - ends[a][leaf];
  });
}

void BlockTree::release() noexcept {
  release_columns(nodes_, filters_, shape_);
}

Bytes BlockTree::bytes() const noexcept {
  return bytes_of(nodes_, filters_, shape_);
}

}  // namespace winnow
