#pragma once

#include "partitions/rows/row_partition.h"
#include "partitions/structures/levels/hierarchical_grid.kernel.h"
#include "partitions/structures/levels/level_layout.h"

#include <array>

namespace winnow {

/// Uniform grids laid over each other, one for each range of sizes (Overmars, "Point location in
/// fat subdivisions", Information Processing Letters 44, 1992; Ericson, "Real-Time Collision
/// Detection", 2005, 7.2), for scenes of small and large objects, up to 1e12 : 1. Which ranges of
/// sizes get a level of their own is worked out at each build from how many objects of which size
/// there are: a scene of one size has one level. No parameter, no world bounds.
///
/// An object belongs to the one cell, of its level, of its box's lower corner. Cells lie in lines
/// of which only those are stored that hold objects, and a line's cells reach from its first object
/// to its last: memory follows the number of objects, whatever the size of the world. Rows are
/// sorted by level, line and cell; 16 rows that follow each other lie close together and look for
/// partners together, in their own level and in those of larger objects, so each pair is met once.
/// Objects may drift from their cell by a slack, so that slow scenes keep their order for many
/// frames.
///
/// Unbounded objects, those of sizes beyond 1e12 : 1, and crowds that no cell tells apart go to a
/// block tree and are asked against the levels. Self pairs: O(n log n + n * levels + pairs) where
/// density is even. Exact. `statistics().cells` counts the cells of all levels.
class HierarchicalGrid final : public RowPartition {
 public:
  explicit HierarchicalGrid(const PartitionOptions& options = {});

  [[nodiscard]] std::string_view name() const noexcept override { return "HierarchicalGrid"; }

  /// Levels made by the last build, 0 if it made none.
  [[nodiscard]] std::size_t levels() const noexcept {
    return regular_rows() == 0 ? 0 : level_count_;
  }

 private:
  bool plan(Column<std::uint32_t>& regular, Column<std::uint32_t>& rest) override;
  void finish_build() override;
  [[nodiscard]] bool fits(std::size_t row) const noexcept override;
  void find_misfits(Column<std::uint32_t>& rows, std::size_t limit) noexcept override;
  [[nodiscard]] std::size_t regular_tasks() const noexcept override;
  bool run_regular_task(std::size_t task, PairSink& sink) const noexcept override;
  bool query_regular(const QueryBatch& batch, PairSink& sink) const noexcept override;
  void draw_regular(DebugDraw& draw, const DebugDrawOptions& options) const override;
  void release_structure() noexcept override;
  void add_structure_bytes(Footprint& footprint) const noexcept override;
  [[nodiscard]] std::size_t cell_count() const noexcept override;

  struct Sorted;
  void sort_by_level(const SizeClasses& classes, std::span<std::uint32_t> end,
                     Column<std::uint32_t>& rest) noexcept;
  bool build_level(std::span<const std::uint32_t> rows, Column<std::uint32_t>& regular,
                   Column<std::uint32_t>& rest);
  bool add_line(const Sorted& sorted, std::size_t begin, std::size_t end,
                Column<std::uint32_t>& regular, Column<std::uint32_t>& rest);
  bool rank_lines(GridLevel& level);
  [[nodiscard]] std::uint32_t line_of(const GridLevel& level, std::size_t row) const noexcept;
  [[nodiscard]] std::uint32_t first_line(std::size_t task) const noexcept;
  [[nodiscard]] LevelsView view() const noexcept;

  std::array<GridLevel, kMostLevels> level_;
  std::size_t level_count_ = 0;
  Column<GridLine> line_;
  Column<std::uint32_t> number_;  // of each line
  Column<std::uint32_t> rank_;    // lines below each number, level by level
  Column<std::uint32_t> start_;   // first row of each cell, and the end
  Column<float> key_;             // by row: lower end on the fast axis at the build
  Column<std::uint32_t> list_;    // rows by level, while building; then scratch
};

}  // namespace winnow
