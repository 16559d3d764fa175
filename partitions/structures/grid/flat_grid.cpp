#include "partitions/structures/grid/flat_grid.h"

#include "core/sort/counting_sort.h"
#include "partitions/structures/cells/cell_drawing.h"
#include "partitions/structures/cells/task_lists.h"

#include <algorithm>

namespace winnow {

WINNOW_DEFINE_KERNELS(FlatGridKernels, flat_grid_kernels)

namespace {

// More objects than this in a cell are pruned better by the tree.
constexpr std::uint32_t kOverfull = 48;

}  // namespace

FlatGrid::FlatGrid(const PartitionOptions& options)
    : RowPartition(options, options.volume),
      layout_(options.memory),
      start_(options.memory),
      cell_(options.memory) {}

bool FlatGrid::plan(Column<std::uint32_t>& regular, Column<std::uint32_t>& rest) {
  const SceneSample sample(pool());
  if (!layout_.choose(sample, {.rows_per_block = 10})) return false;
  if (!layout_.usable()) return RowPartition::plan(regular, rest);
  if (!cell_.resize(pool().rows()) || !start_.resize(layout_.cells() + 1)) return false;
  count_cells();
  drop_overfull();
  regular.set_size(positions_from_counts(start_));
  for (std::size_t row = 0; row < pool().rows(); ++row) {
    if (cell_[row] != CellLayout::kNoCell) {
      regular[start_[cell_[row]]++] = static_cast<std::uint32_t>(row);
    } else if (pool().ids()[row] != kNoObject) {
      (void)rest.push_back(static_cast<std::uint32_t>(row));
    }
  }
  starts_from_positions(start_);
  return true;
}

void FlatGrid::count_cells() noexcept {
  std::fill(start_.begin(), start_.end(), 0);
  for (std::size_t row = 0; row < pool().rows(); ++row) {
    const bool live = pool().ids()[row] != kNoObject;
    cell_[row] = live ? layout_.cell_of(pool(), row) : CellLayout::kNoCell;
    if (cell_[row] != CellLayout::kNoCell) ++start_[cell_[row]];
  }
}

void FlatGrid::drop_overfull() noexcept {
  if (std::none_of(start_.begin(), start_.end(), [](auto n) { return n > kOverfull; })) return;
  for (std::uint32_t& cell : cell_) {
    if (cell != CellLayout::kNoCell && start_[cell] > kOverfull) cell = CellLayout::kNoCell;
  }
  std::replace_if(
      start_.begin(), start_.end(), [](auto n) { return n > kOverfull; }, 0U);
}

bool FlatGrid::fits(std::size_t row) const noexcept {
  // Mostly the box's own corner still lies in the cell that holds the row.
  const std::uint32_t own = layout_.cell_of(pool(), row);
  if (own != CellLayout::kNoCell && row >= start_[own] && row < start_[own + 1]) return true;
  const auto after = std::upper_bound(start_.begin(), start_.end(), row);
  return layout_.fits(pool(), row, static_cast<std::uint32_t>(after - start_.begin() - 1));
}

void FlatGrid::find_misfits(Column<std::uint32_t>& rows, std::size_t limit) noexcept {
  const GridView grid = view();
  const std::size_t cells = layout_.axis(0).count;
  append_in_order(
      execution(), regular_tasks(), cell_.data(),
      [&](std::size_t task) { return start_[first_line(task) * cells]; },
      [&](std::size_t task, std::uint32_t* out) {
        return flat_grid_kernels().find_misfits(grid, first_line(task), first_line(task + 1), out);
      },
      rows, limit);
}

std::uint32_t FlatGrid::first_line(std::size_t task) const noexcept {
  return static_cast<std::uint32_t>(lines() * task / regular_tasks());
}

std::size_t FlatGrid::lines() const noexcept {
  return std::size_t{layout_.axis(1).count} * layout_.axis(2).count;
}

std::size_t FlatGrid::regular_tasks() const noexcept {
  return regular_rows() == 0 ? 0 : std::min(kMostTasks, lines());
}

bool FlatGrid::run_regular_task(std::size_t task, PairSink& sink) const noexcept {
  return flat_grid_kernels().self_pairs(view(), first_line(task), first_line(task + 1), sink);
}

bool FlatGrid::query_regular(const QueryBatch& batch, PairSink& sink) const noexcept {
  return flat_grid_kernels().query(view(), batch, sink);
}

GridView FlatGrid::view() const noexcept {
  return {row_view(), start_.data(), {layout_.axis(0), layout_.axis(1), layout_.axis(2)}};
}

void FlatGrid::draw_regular(DebugDraw& draw, const DebugDrawOptions&) const {
  draw_cells(draw, layout_, row_view(), start_, "runs fastest");
}

void FlatGrid::release_structure() noexcept {
  layout_.release();
  start_.release();
  cell_.release();
}

void FlatGrid::add_structure_bytes(Footprint& footprint) const noexcept {
  footprint.structure += layout_.bytes();
  footprint.structure += start_.bytes();
  footprint.scratch += cell_.bytes();
}

std::size_t FlatGrid::cell_count() const noexcept {
  return regular_rows() == 0 ? RowPartition::cell_count() : layout_.cells();
}

}  // namespace winnow
