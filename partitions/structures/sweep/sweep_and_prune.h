#pragma once

#include "partitions/rows/row_partition.h"
#include "partitions/structures/cells/cell_layout.h"
#include "partitions/structures/sweep/sweep_and_prune.kernel.h"

namespace winnow {

/// Sorted sweep-and-prune (Baraff, "Dynamic Simulation of Non-Penetrating Rigid Bodies", 1992) in
/// strips: objects are bucketed on the two axes that are not swept and sorted on the third, the one
/// with the most room in units of the objects' own edges. Sixteen rows that follow each other in a
/// strip sweep together, forward in it and in the four neighbouring strips after it: one box around
/// them picks the candidates, 16 at a time. An axis that prunes nothing is not divided, so one bad
/// axis ruins nothing. A row may drift from its sort key by a bound that the sweep allows for: slow
/// motion, or rest, costs no sorting. Objects wider than strips go to a block tree, and where they
/// are many it holds the whole scene. Self pairs: O(n log n + n * objects met in a sweep + pairs).
/// Exact.
class SweepAndPrune final : public RowPartition {
 public:
  explicit SweepAndPrune(const PartitionOptions& options = {});

  [[nodiscard]] std::string_view name() const noexcept override { return "SweepAndPrune"; }

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

  std::size_t list_rows(Column<std::uint32_t>& rest) noexcept;
  void sort_rows(std::size_t count, Column<std::uint32_t>& regular) noexcept;
  void drop_crowded(Column<std::uint32_t>& regular, Column<std::uint32_t>& rest) noexcept;
  [[nodiscard]] bool near_key(std::size_t row) const noexcept;
  [[nodiscard]] bool fits_strip(std::size_t row, std::uint32_t strip) const noexcept;
  [[nodiscard]] std::uint32_t first_strip(std::size_t task) const noexcept;
  [[nodiscard]] StripView view() const noexcept;

  CellLayout layout_;
  Column<std::uint32_t> start_;  // first row of each strip, and the end
  Column<float> key_;            // by row: lower end on the sweep axis at the build
  Column<std::uint32_t> strip_;  // of each row, while building; then scratch
};

}  // namespace winnow
