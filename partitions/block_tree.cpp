#include <winnow/partitions/block_tree.h>

#include <algorithm>
#include <limits>

namespace winnow {

WINNOW_DEFINE_KERNELS(BlockTreeKernels, block_tree_kernels)

namespace {

constexpr std::size_t kLeavesPerTask = 1024;

constexpr std::size_t padded(std::size_t nodes) {
  return (nodes + 15) / 16 * 16;
}

}  // namespace

bool BlockTree::cover(std::size_t first_block, std::size_t blocks) noexcept {
  TreeView shape;
  shape.first_block = static_cast<std::uint32_t>(first_block);
  std::size_t total = 0;
  if (blocks != 0) {
    std::size_t nodes = blocks;
    for (;;) {
      shape.count[shape.levels++] = static_cast<std::uint32_t>(nodes);
      total += 6 * padded(nodes);
      if (nodes <= 16) break;
      nodes = (nodes + 15) / 16;
    }
  }
  // Node values are recomputed: nothing to carry over into larger memory.
  nodes_.clear();
  if (!nodes_.grow(total)) {
    shape_ = {};
    return false;
  }
  nodes_.set_size(total);
  float* at = nodes_.data();
  for (std::uint32_t level = 0; level < shape.levels; ++level) {
    const std::size_t stride = padded(shape.count[level]);
    for (std::size_t c = 0; c < 6; ++c) {
      shape.node[level][c] = at;
      const float inf = std::numeric_limits<float>::infinity();
      std::fill(at + shape.count[level], at + stride, c < 3 ? inf : -inf);
      at += stride;
    }
  }
  shape_ = shape;
  return true;
}

TreeView BlockTree::view(const RowView& rows) const noexcept {
  TreeView result = shape_;
  result.rows = rows;
  return result;
}

void BlockTree::refit_all(const RowView& rows, const Execution& execution) noexcept {
  const TreeView tree = view(rows);
  const BlockTreeKernels& kernels = block_tree_kernels();
  const std::size_t tasks = (blocks() + kLeavesPerTask - 1) / kLeavesPerTask;
  execution.for_each(tasks, [&](std::size_t task) {
    const std::size_t begin = task * kLeavesPerTask;
    const std::size_t end = std::min(blocks(), begin + kLeavesPerTask);
    kernels.refit_leaves(tree, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
  });
  for (std::uint32_t level = 1; level < tree.levels; ++level) {
    kernels.refit_nodes(tree, level, 0, tree.count[level]);
  }
}

void BlockTree::refit(const RowView& rows, std::span<std::uint32_t> leaves) noexcept {
  const TreeView tree = view(rows);
  const BlockTreeKernels& kernels = block_tree_kernels();
  for (const std::uint32_t leaf : leaves) kernels.refit_leaves(tree, leaf, leaf + 1);
  for (std::uint32_t level = 1; level < tree.levels; ++level) {
    for (std::uint32_t& node : leaves) node /= 16;
    leaves = {leaves.begin(), std::unique(leaves.begin(), leaves.end())};
    for (const std::uint32_t node : leaves) kernels.refit_nodes(tree, level, node, node + 1);
  }
}

void BlockTree::release() noexcept {
  nodes_.release();
  shape_ = {};
}

}  // namespace winnow
