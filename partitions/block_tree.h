#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include <winnow/partitions/block_tree.kernel.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// The node boxes of an implicit 16-ary tree over consecutive blocks of rows. It owns no order:
/// rows that lie near each other in space must lie near each other in the pool for it to prune. Any
/// order gives right answers.
class BlockTree {
 public:
  explicit BlockTree(std::pmr::memory_resource* memory) noexcept : nodes_(memory) {}

  /// Sets which blocks the tree covers; node boxes are then undefined until `refit_all`. False, and
  /// unchanged, if memory is refused.
  [[nodiscard]] bool cover(std::size_t first_block, std::size_t blocks) noexcept;

  /// Recomputes every node. O(blocks).
  void refit_all(const RowView& rows, const Execution& execution) noexcept;

  /// Recomputes the nodes above the given leaves (ascending, without repeats; overwritten).
  void refit(const RowView& rows, std::span<std::uint32_t> leaves) noexcept;

  [[nodiscard]] TreeView view(const RowView& rows) const noexcept;
  [[nodiscard]] std::size_t first_block() const noexcept { return shape_.first_block; }
  [[nodiscard]] std::size_t blocks() const noexcept { return shape_.count[0]; }
  [[nodiscard]] std::size_t levels() const noexcept { return shape_.levels; }
  /// Nodes one level above the blocks: the units in which pair finding is split.
  [[nodiscard]] std::size_t groups() const noexcept { return (blocks() + 15) / 16; }

  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept { return nodes_.bytes(); }

 private:
  Column<float> nodes_;
  TreeView shape_;  // rows unset: the pool may move between calls
};

}  // namespace winnow
