#pragma once

#include "partitions/rows/row_partition.h"
#include "partitions/structures/cells/cell_layout.h"
#include "partitions/structures/grid/flat_grid.kernel.h"

namespace winnow {

/// Uniform grid: each object belongs to the one cell of its box's lower corner, and rows are sorted
/// by cell (counting sort), so that the cells of a line are one run of rows. 16 rows of a line look
/// for partners together, behind them in their own line and in the neighbouring ones: each pair is
/// met once and no object is stored twice. Cells are wider than the boxes by a slack that objects
/// may drift within, so that slow scenes keep their order for many frames. Cell size, the axis that
/// runs fastest, and which objects are too large for cells come from a sample of the scene at each
/// build. Objects too large or in overfull cells go to a block tree and are asked against the grid.
/// Self pairs: O(n + cells + pairs) where density is even. Exact.
class FlatGrid final : public RowPartition {
 public:
  explicit FlatGrid(const PartitionOptions& options = {});

  [[nodiscard]] std::string_view name() const noexcept override { return "FlatGrid"; }

 private:
  bool plan(Column<std::uint32_t>& regular, Column<std::uint32_t>& rest) override;
  [[nodiscard]] bool fits(std::size_t row) const noexcept override;
  void find_misfits(Column<std::uint32_t>& rows, std::size_t limit) noexcept override;
  [[nodiscard]] std::size_t regular_tasks() const noexcept override;
  bool run_regular_task(std::size_t task, PairSink& sink) const noexcept override;
  bool query_regular(const QueryBatch& batch, PairSink& sink) const noexcept override;
  void draw_regular(DebugDraw& draw, const DebugDrawOptions& options) const override;
  void release_structure() noexcept override;
  void add_structure_bytes(Footprint& footprint) const noexcept override;
  [[nodiscard]] std::size_t cell_count() const noexcept override;

  void count_cells() noexcept;
  void drop_overfull() noexcept;
  [[nodiscard]] std::size_t lines() const noexcept;
  [[nodiscard]] std::uint32_t first_line(std::size_t task) const noexcept;
  [[nodiscard]] GridView view() const noexcept;

  CellLayout layout_;
  Column<std::uint32_t> start_;  // first row of each cell, and the end
  Column<std::uint32_t> cell_;   // cell of each row, while building; then scratch
};

}  // namespace winnow
