#pragma once

#include "core/memory/columns.h"
#include "core/sort/counting_sort.h"
#include "partitions/structures/structure.h"
#include "partitions/structures/tasks.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace winnow {

/// What structures have in common whose regular rows lie in cells, one after another: how pair
/// finding and the search for what left its cell are cut into tasks, and whose memory is whose.
/// Each holds its cells twice: as they are in use, and as the next build plans them.
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
  /// What is left to the tree of a first build, which is to be there soon, is cut coarsely.
  [[nodiscard]] KdParts first_parts() const noexcept final { return KdParts::cells; }
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

  /// Room for a build of so many cells and listed rows, or of none but the tree's.
  [[nodiscard]] bool reserve_cells(const BuildRoom& room, std::size_t cells,
                                   std::size_t listed) noexcept {
    return Structure::reserve(room) && planned_start_.reserve(cells + 1, room.pages) &&
           room.list.reserve(listed, room.pages);
  }

  /// Into how many units pair finding can be cut, where there are regular rows.
  [[nodiscard]] virtual std::size_t pair_units() const noexcept { return places(); }
  /// Pairs of the regular rows of units [begin, end) with each other and with rows behind them.
  virtual bool find_pairs(std::uint32_t begin, std::uint32_t end,
                          PairSink& sink) const noexcept = 0;

  /// Cells, or lines of cells: what rows are searched by for those that left.
  [[nodiscard]] virtual std::size_t places() const noexcept = 0;
  [[nodiscard]] virtual std::uint32_t first_row(std::uint32_t place) const noexcept = 0;
  /// Writes to `out` the rows of places [begin, end) that left; returns how many.
  virtual std::size_t write_misfits(std::uint32_t begin, std::uint32_t end,
                                    std::uint32_t* out) const noexcept = 0;

  /// Rows that do not fit cells ask all cells that they cross: where more than a tenth of a scene
  /// does so, the tree serves all of it better.
  [[nodiscard]] static bool are_too_many_apart(std::size_t apart, const RowPlan& plan) noexcept {
    return apart > plan.objects / 10;
  }
  /// Makes every live row part of the rest, whatever the plan has listed.
  void leave_cells(const RowPlan& plan) const noexcept {
    plan.regular.clear();
    plan.rest.clear();
    leave_all(plan);
  }

  /// Makes those live rows that have no cell in the plan's list part of the rest; `regular` others
  /// have one.
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
    // Of fewer rows the pairs are sooner found than a task is begun.
    constexpr std::size_t kRowsOfTask = 128;
    if (regular_rows() == 0) return {};
    return {pair_units(), std::min(kMostTasks, regular_rows() / kRowsOfTask + 1)};
  }
};

}  // namespace winnow
