#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include "partitions/tree/block_tree.kernel.h"
#include "partitions/tree/node_filters.h"

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
  explicit BlockTree(std::pmr::memory_resource* memory) noexcept
      : nodes_(memory), filters_(memory), shape_(memory) {}

  /// What nodes hold.
  enum class Nodes : std::uint8_t {
    boxes,          ///< of the rows below them
    boxes_filters,  ///< and what the rows' filters have between them
    filters,        ///< that alone: of rows in no spatial order
  };

  /// Sets which blocks the tree covers; nodes are then undefined until `refit_all`. False, and then
  /// it covers none, if memory is refused.
  [[nodiscard]] bool cover(std::size_t first_block, std::size_t blocks,
                           Nodes nodes = Nodes::boxes) noexcept;

  /// Covers another number of blocks, not 0, from the same one on, if their nodes have room where
  /// those of now are: a sixteenth more than `cover` was told of mostly have. Nodes above the
  /// blocks that come, or above the last one, are then to be refitted. False, and unchanged, if
  /// they have not.
  [[nodiscard]] bool stretch(std::size_t blocks) noexcept;

  /// Makes room for the boxes of a tree over so many blocks. False, and unchanged, if memory is
  /// refused.
  [[nodiscard]] bool reserve(std::size_t blocks, Pages pages) noexcept;

  /// Recomputes every node, but what nodes know of filters only where rows were rearranged since
  /// that was done last. O(blocks).
  void refit_all(const RowView& rows, const Execution& execution) noexcept;

  /// Recomputes the nodes above the given leaves (ascending, without repeats; overwritten), which
  /// are all whose rows changed since the last time; of filters again what was rearranged.
  void refit(const RowView& rows, std::span<std::uint32_t> leaves) noexcept;

  [[nodiscard]] TreeView view(const RowView& rows) const noexcept;
  /// Stays where it is until `cover` is called.
  [[nodiscard]] const TreeShape& shape() const noexcept {
    static constexpr TreeShape kNone;
    return shape_.empty() ? kNone : shape_[0];
  }
  [[nodiscard]] std::size_t first_block() const noexcept { return shape().first_block; }
  [[nodiscard]] std::size_t blocks() const noexcept { return shape().count[0]; }
  [[nodiscard]] std::size_t levels() const noexcept { return shape().levels; }
  [[nodiscard]] bool has_filters() const noexcept { return shape().filters[0].layers != nullptr; }
  /// Nodes one level above the blocks: the units in which pair finding is split.
  [[nodiscard]] std::size_t groups() const noexcept { return (blocks() + 15) / 16; }

  /// The mean edge of a block in the middle of a sample; 0 if there are none.
  [[nodiscard]] float typical_edge() const noexcept;

  /// True if the mean edge of a block is longer than `edge`.
  [[nodiscard]] bool is_wide(std::size_t block, float edge) const noexcept {
    float sum = 0.0F;
    const float* const* const leaf = shape().node[0];
    for (std::size_t c = 0; c < 3; ++c) sum += leaf[3 + c][block] - leaf[c][block];
    return sum > 3.0F * edge;
  }
  /// How many of the first blocks are. O(count).
  [[nodiscard]] std::size_t count_wide(std::size_t count, float edge) const noexcept {
    std::size_t wide = 0;
    for (std::size_t block = 0; block < count; ++block) wide += is_wide(block, edge) ? 1U : 0U;
    return wide;
  }

  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  [[nodiscard]] bool lay_boxes(TreeShape& shape) noexcept;
  void aim_boxes(TreeShape& shape) noexcept;

  Column<float> nodes_;
  Column<std::uint32_t> filters_;
  Column<TreeShape> shape_;       // one; none while the tree covers nothing
  std::uint32_t laid_out_ = 0;    // blocks that nodes have room for
  std::uint64_t filters_of_ = 0;  // the arrangement of rows that all filters are right for
};

}  // namespace winnow
