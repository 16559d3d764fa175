#pragma once

#include "core/memory/columns.h"
#include "core/sort/counting_sort.h"
#include "partitions/structures/structure.h"
#include "partitions/structures/tasks.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// What structures have in common whose regular rows lie in cells, one after another: how pair
/// finding and the search for what left its cell are cut into tasks, and whose memory is whose.
class CellStructure : public Structure {
 public:
  explicit CellStructure(const StructureInput& input) noexcept
      : Structure(input), start_(input.memory), list_(input.memory) {}

  void find_misfits(Column<std::uint32_t>& rows, std::size_t limit) noexcept final {
    append_in_order(
        execution(), {places()}, list_.data(),
        [this](std::uint32_t place) { return first_row(place); },
        [this](std::uint32_t begin, std::uint32_t end, std::uint32_t* out) {
          return write_misfits(begin, end, out);
        },
        rows, limit);
  }
  [[nodiscard]] std::size_t pair_tasks() const noexcept final { return pair_cut().tasks(); }
  bool run_pair_task(std::size_t task, PairSink& sink) const noexcept final {
    const TaskCut cut = pair_cut();
    return find_pairs(cut.first(task), cut.first(task + 1), sink);
  }
  void release_memory() noexcept override { release_columns(start_, list_); }
  void add_bytes(Footprint& footprint) const noexcept override {
    footprint.structure += start_.bytes();
    footprint.scratch += list_.bytes();
  }

 protected:
  ~CellStructure() = default;

  /// Room for a build of so many cells and listed rows, or of none but the tree's.
  [[nodiscard]] bool reserve_cells(const BuildRoom& room, std::size_t cells,
                                   std::size_t listed) noexcept {
    return Structure::reserve(room) && start_.reserve(cells + 1, room.pages) &&
           list_.reserve(listed, room.pages);
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

  /// Makes those live rows that have no cell in list_ part of the rest; `regular` others have one.
  void list_rest(std::size_t regular, const RowPlan& plan) const noexcept {
    const std::size_t most = objects() - regular;
    for (std::size_t row = 0; row < pool().rows() && plan.rest.size() < most; ++row) {
      if (list_[row] != CountingSort::kNone || pool().ids()[row] == kNoObject) continue;
      (void)plan.rest.push_back(static_cast<std::uint32_t>(row));
    }
  }

  Column<std::uint32_t> start_;  ///< first row of each cell, and the end
  Column<std::uint32_t> list_;   ///< while building what it likes; then room for the rows that left

 private:
  [[nodiscard]] TaskCut pair_cut() const noexcept {
    return {regular_rows() == 0 ? 0 : pair_units()};
  }
};

}  // namespace winnow
