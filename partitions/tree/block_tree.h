#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/memory.h>
#include "partitions/tree/block_tree.kernel.h"
#include "partitions/tree/node_filters.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Returns the median, over a sample of `blocks` blocks, of a block's mean edge; 0 if there are no
/// blocks. edge_of(block, axis) returns the length of an edge.
template <typename EdgeOf>
[[nodiscard]] float median_edge(std::size_t blocks, EdgeOf&& edge_of) {
  constexpr std::size_t kSample = 31;
  std::array<float, kSample> edge{};
  const std::size_t count = std::min(kSample, blocks);
  if (count == 0) return 0.0F;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t a = 0; a < 3; ++a) edge[i] += edge_of(blocks * i / count, a) / 3.0F;
  }
  std::nth_element(edge.begin(), edge.begin() + count / 2, edge.begin() + count);
  return edge[count / 2];
}

/// The node boxes of an implicit 16-ary tree over consecutive blocks of rows. The tree does not
/// order the rows: it prunes well if rows that are close in space are close in the pool. Results
/// are correct for any order.
class BlockTree {
 public:
  explicit BlockTree(std::pmr::memory_resource* memory) noexcept
      : nodes_(memory), filters_(memory), shape_(memory) {}

  /// Contents of nodes.
  enum class NodeContent : std::uint8_t {
    boxes,          ///< bounds of the rows below
    boxes_filters,  ///< also a summary of the filters of the rows
    filters,        ///< only filters, for rows in no spatial order
  };

  /// Sets the blocks that the tree covers; nodes are undefined until `refit_all`. Returns false if
  /// an allocation fails; the tree then covers no blocks.
  [[nodiscard]] bool cover(std::size_t first_block, std::size_t blocks,
                           NodeContent nodes = NodeContent::boxes) noexcept;

  /// Changes the number of covered blocks (not 0) if there is room for their nodes, usually up to a
  /// sixteenth more than in `cover`. The nodes above added blocks, or above the last block, have to
  /// be refitted afterwards. Returns false and changes nothing if there is no room.
  [[nodiscard]] bool try_resize(std::size_t blocks) noexcept;

  /// Makes room for the boxes of a tree over `blocks` blocks. Returns false and changes nothing if
  /// an allocation fails.
  [[nodiscard]] bool reserve(std::size_t blocks, Pages pages) noexcept;

  /// Recomputes every node. Recomputes filters only if rows or filters changed since the last call
  /// (RowView::arrangement). O(blocks).
  void refit_all(const RowView& rows, const Execution& execution) noexcept;

  /// Recomputes the nodes above the given leaves (ascending, unique; overwritten), which must be
  /// all leaves whose rows changed since the last refit. Recomputes their filters only if rows or
  /// filters changed.
  void refit(const RowView& rows, std::span<std::uint32_t> leaves) noexcept;

  [[nodiscard]] TreeView view(const RowView& rows) const noexcept;
  /// Remains valid until `cover` is called.
  [[nodiscard]] const TreeShape& shape() const noexcept {
    static constexpr TreeShape kNone;
    return shape_.empty() ? kNone : shape_[0];
  }
  [[nodiscard]] std::size_t first_block() const noexcept { return shape().first_block; }
  [[nodiscard]] std::size_t blocks() const noexcept { return shape().count[0]; }
  [[nodiscard]] std::size_t levels() const noexcept { return shape().levels; }
  [[nodiscard]] bool has_filters() const noexcept { return shape().filters[0].layers != nullptr; }
  /// Nodes one level above the blocks: the units of work of pair finding.
  [[nodiscard]] std::size_t groups() const noexcept { return (blocks() + 15) / 16; }

  /// Returns the median edge of the leaves; 0 if there are none.
  [[nodiscard]] float typical_edge() const noexcept;

  /// True if the mean edge of a block is longer than `edge`.
  [[nodiscard]] bool is_wide(std::size_t block, float edge) const noexcept {
    float sum = 0.0F;
    const float* const* const leaf = shape().node[0];
    for (std::size_t c = 0; c < 3; ++c) sum += leaf[3 + c][block] - leaf[c][block];
    return sum > 3.0F * edge;
  }
  /// Returns how many of the first `count` blocks are wide. O(count).
  [[nodiscard]] std::size_t count_wide(std::size_t count, float edge) const noexcept {
    std::size_t wide = 0;
    for (std::size_t block = 0; block < count; ++block) wide += is_wide(block, edge) ? 1U : 0U;
    return wide;
  }

  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  [[nodiscard]] bool lay_boxes(TreeShape& shape) noexcept;
  void set_box_pointers(TreeShape& shape) noexcept;

  Column<float> nodes_;
  Column<std::uint32_t> filters_;
  Column<TreeShape> shape_;       // one entry, or none while the tree covers nothing
  std::uint32_t laid_out_ = 0;    // blocks that nodes have room for
  std::uint64_t filters_of_ = 0;  // the arrangement of rows for which all filters are correct
};

}  // namespace winnow
