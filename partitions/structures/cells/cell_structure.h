#pragma once

#include "core/memory/columns.h"
#include "core/sort/counting_sort.h"
#include "partitions/structures/structure.h"
#include "partitions/structures/tasks.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace winnow {

/// Base class of structures whose regular rows are sorted by cell: divides pair finding and the
/// search for misfits into tasks, and owns the starts of cells, both current and planned.
class CellStructure : public Structure {
 public:
  explicit CellStructure(const StructureInput& input) noexcept
      : Structure(input), start_(input.memory), planned_start_(input.memory) {}

  bool find_misfits(std::uint32_t* room, Column<std::uint32_t>& rows,
                    std::size_t most) noexcept final {
    return append_in_order(
        execution(), {places()}, regular_rows(), room,
        [this](std::uint32_t place) { return first_row(place); },
        [this](std::uint32_t begin, std::uint32_t end, std::uint32_t* out) {
          return write_misfits(begin, end, out);
        },
        rows, most);
  }
  /// The first build should take little time, so the tree's rows are ordered coarsely.
  [[nodiscard]] KdPrecision first_precision() const noexcept final { return KdPrecision::cells; }
  [[nodiscard]] std::size_t pair_tasks() const noexcept final { return pair_cut().tasks(); }
  bool run_pair_task(std::size_t task, PairSink& sink) const noexcept final {
    const TaskCut cut = pair_cut();
    return find_pairs(cut.first(task), cut.first(task + 1), sink);
  }
  void release_memory() noexcept override { release_columns(start_, planned_start_); }
  void add_bytes(Footprint& footprint) const noexcept override {
    footprint.structure += bytes_of(start_, planned_start_);
  }

 protected:
  ~CellStructure() = default;

  /// Makes room for a build with up to `cells` cells and `listed` entries of the list, or with all
  /// rows in the tree.
  [[nodiscard]] bool reserve_cells(const BuildRoom& room, std::size_t cells,
                                   std::size_t listed) noexcept {
    return Structure::reserve(room) && planned_start_.reserve(cells + 1, room.pages) &&
           room.list.reserve(listed, room.pages);
  }

  /// The number of units that pair finding can be divided into if there are regular rows.
  [[nodiscard]] virtual std::size_t pair_units() const noexcept { return places(); }
  /// Finds the pairs of the regular rows of units [begin, end) with each other and with rows behind
  /// them.
  virtual bool find_pairs(std::uint32_t begin, std::uint32_t end,
                          PairSink& sink) const noexcept = 0;

  /// The number of places, which are cells or lines of cells: the units of the search for misfits.
  [[nodiscard]] virtual std::size_t places() const noexcept = 0;
  [[nodiscard]] virtual std::uint32_t first_row(std::uint32_t place) const noexcept = 0;
  /// Writes the rows of places [begin, end) that no longer fit to `out`; returns their number.
  virtual std::size_t write_misfits(std::uint32_t begin, std::uint32_t end,
                                    std::uint32_t* out) const noexcept = 0;

  /// Rows outside cells query all cells that they cross. If they are more than a tenth of the
  /// scene, the tree is better for all rows.
  [[nodiscard]] static bool are_too_many_outside_cells(std::size_t apart,
                                                       const RowPlan& plan) noexcept {
    return apart > plan.objects / 10;
  }
  /// Discards the plan's lists and makes every live row part of the rest.
  void move_all_to_rest(const RowPlan& plan) const noexcept {
    plan.regular.clear();
    plan.rest.clear();
    append_all_to_rest(plan);
  }

  /// Appends to the rest all live rows that have no cell in the plan's list; `regular` is the
  /// number of rows that have one.
  void list_rest(std::size_t regular, const RowPlan& plan) const noexcept {
    const std::size_t most = plan.objects - regular;
    for (std::size_t row = 0; row < plan.rows && plan.rest.size() < most; ++row) {
      if (plan.list[row] != CountingSort::kNone || pool().ids()[row] == kNoObject) continue;
      (void)plan.rest.push_back(static_cast<std::uint32_t>(row));
    }
  }

  Column<std::uint32_t> start_;  ///< first row of each cell, and the end
  Column<std::uint32_t> planned_start_;

 private:
  [[nodiscard]] TaskCut pair_cut() const noexcept {
    // With fewer rows, starting a task costs more than finding the pairs.
    constexpr std::size_t kRowsOfTask = 128;
    if (regular_rows() == 0) return {};
    return {pair_units(), std::min(kMaxTasks, regular_rows() / kRowsOfTask + 1)};
  }
};

}  // namespace winnow
