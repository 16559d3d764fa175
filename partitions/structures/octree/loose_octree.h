#pragma once

#include "partitions/rows/row_partition.h"
#include "partitions/structures/octree/loose_octree_cells.h"

namespace winnow {

struct LooseOctreeOptions {
  /// Edge of a loose cell in edges of its cell, in [1.125, 8]; what lies outside is taken as the
  /// nearest end. Larger: objects move farther before they leave their node, and nodes overlap
  /// more. Measured where sizes are mixed: 1.5 and 3 cost 7 to 14 % more tests than 2.
  float loose = 2.0F;
};

/// Loose octree (Ulrich, "Loose Octrees", Game Programming Gems, 2000) without pointers: an object
/// lives in the one node of its size's level whose cell holds its centre. Nodes are runs of rows in
/// flat arrays, sorted by level, large objects first, and along Hilbert's curve within a level
/// (which leaves blocks of rows a third less surface than Morton's); each has its linear code. A
/// node's cell is loose, so objects may move by a good part of it, and the node stays as it is.
///
/// Nodes overlap their neighbours by design and may be nearly empty, so they are not what is
/// tested: every 16 rows in node order have a tight box, and 16 of these at once are pruned as in a
/// block tree. Objects larger than the root, outside of it or without end, and those that have left
/// their loose cells, are kept in a block tree beside it. In a world two cells thick it divides two
/// axes only. Seldom the fastest and never far from it, whatever the sizes. Self pairs: O(n log n +
/// pairs) for boxes of bounded overlap. Exact.
class LooseOctree : public RowPartition {
 public:
  explicit LooseOctree(const PartitionOptions& options = {}, const LooseOctreeOptions& loose = {});

  [[nodiscard]] std::string_view name() const noexcept override { return "LooseOctree"; }
  /// From the root to the finest nodes; 0 if there are none. Statistics counts the nodes that hold
  /// objects as cells.
  [[nodiscard]] std::size_t levels() const noexcept {
    return regular_rows() == 0 ? 0 : cells_.levels();
  }

 protected:
  LooseOctree(const PartitionOptions& options, const LooseOctreeOptions& loose, std::size_t axes);

 private:
  bool plan(Column<std::uint32_t>& regular, Column<std::uint32_t>& rest) override;
  [[nodiscard]] bool prunes_rows() const noexcept override { return true; }
  [[nodiscard]] bool fits(std::size_t row) const noexcept override;
  void find_misfits(Column<std::uint32_t>& rows, std::size_t limit) noexcept override;
  [[nodiscard]] std::size_t regular_tasks() const noexcept override;
  bool run_regular_task(std::size_t task, PairSink& sink) const noexcept override;
  bool query_regular(const QueryBatch& batch, PairSink& sink) const noexcept override;
  void draw_regular(DebugDraw& draw, const DebugDrawOptions& options) const override;
  void release_structure() noexcept override;
  void add_structure_bytes(Footprint& footprint) const noexcept override;
  [[nodiscard]] std::size_t cell_count() const noexcept override;

  void find_keys() noexcept;
  [[nodiscard]] bool add_node(std::size_t row, std::uint32_t key, std::size_t start);

  const std::size_t axes_;
  const float loose_;
  LooseOctreeCells cells_;
  Column<std::uint32_t> node_;               // level and Morton code
  Column<std::uint32_t> start_;              // first row of each node, and the end
  Column<LooseOctreeCells::Bounds> bounds_;  // of each node's loose cell
  Column<std::uint32_t> left_;               // scratch: rows found to have left their node
};

}  // namespace winnow
