// FlatGrid: plans cells (cells/cell_layout.h), sorts rows by cell, and dispatches to the kernels of
// flat_grid.kernel.cpp.

#include "core/sort/counting_sort.h"
#include "partitions/structures/cells/cell_drawing.h"
#include "partitions/structures/cells/cell_layout.h"
#include "partitions/structures/cells/cell_structure.h"
#include "partitions/structures/costs.h"
#include "partitions/structures/grid/flat_grid.kernel.h"

namespace winnow {

WINNOW_DEFINE_KERNELS(FlatGridKernels, flat_grid_kernels)

namespace {

// If a cell contains more objects than this, the tree prunes them better.
constexpr std::uint32_t kOverfull = 48;
constexpr CellRequirements kRequirements{.rows_per_block = 10};

/// Uniform grid. Each object belongs to the cell of its box's lower corner, and rows are sorted by
/// cell (counting sort), so that the cells of a line are one range of rows. Blocks of 16 rows of a
/// line search together for partners behind them in their line and in neighbouring lines: each pair
/// is found once and no object is stored twice. Cells are wider than the boxes by a slack within
/// which objects may drift, so slow scenes keep their order for many frames. Each build chooses the
/// cell size, the order of axes and the maximum size of objects in cells from a sample of the
/// scene. Objects that are too large or in overfull cells go to a block tree and query the grid; if
/// they are many, all objects go to the tree. Self pairs: O(n + cells + pairs) for even density.
/// Exact.
class FlatGrid final : public CellStructure {
 public:
  explicit FlatGrid(const StructureInput& input) noexcept;

 private:
  [[nodiscard]] bool reserve(const BuildRoom& room) noexcept override;
  [[nodiscard]] PlanStatus plan(const RowPlan& plan, unsigned stage) noexcept override;
  [[nodiscard]] std::size_t plan_passes() const noexcept override { return 2; }
  void finish_build(const RowPlan& plan, bool foreseen) noexcept override;
  [[nodiscard]] bool fits(std::size_t row, const ObjectBox& place) const noexcept override;
  [[nodiscard]] std::size_t places() const noexcept override;
  [[nodiscard]] std::uint32_t first_row(std::uint32_t line) const noexcept override;
  std::size_t write_misfits(std::uint32_t begin, std::uint32_t end,
                            std::uint32_t* out) const noexcept override;
  bool find_pairs(std::uint32_t begin, std::uint32_t end, PairSink& sink) const noexcept override;
  bool query(const QueryBatch& batch, PairSink& sink) const noexcept override;
  void draw(DebugDraw& draw) const override;
  void release_memory() noexcept override;
  void add_bytes(Footprint& footprint) const noexcept override;
  [[nodiscard]] std::size_t cells() const noexcept override;

  [[nodiscard]] PlanStatus choose_cells(const RowPlan& plan) noexcept;
  void sort_by_cell(const RowPlan& plan) noexcept;
  [[nodiscard]] bool drop_overfull(const CountingSort& sort, const RowPlan& plan) const noexcept;
  [[nodiscard]] GridView view() const noexcept;

  CellLayout layout_;
  CellLayout planned_;
};

FlatGrid::FlatGrid(const StructureInput& input) noexcept
    : CellStructure(input), layout_(input.memory), planned_(input.memory) {}

bool FlatGrid::reserve(const BuildRoom& room) noexcept {
  const auto cells =
      static_cast<std::size_t>(kRequirements.max_cells(static_cast<double>(room.objects)));
  return reserve_cells(room, cells, room.objects) && planned_.reserve(cells, room.pages);
}

PlanStatus FlatGrid::plan(const RowPlan& plan, unsigned stage) noexcept {
  if (stage == 0) return choose_cells(plan);
  sort_by_cell(plan);
  return PlanStatus::done;
}

// Writes the cell of each row to `plan.list`.
PlanStatus FlatGrid::choose_cells(const RowPlan& plan) noexcept {
  const SceneSample sample(pool(), plan.objects, execution());
  if (!planned_.choose(sample, kRequirements)) return PlanStatus::out_of_memory;
  if (!planned_.usable()) {
    append_all_to_rest(plan);
    return PlanStatus::done;
  }
  if (!plan.list.resize(plan.rows) || !planned_start_.resize(planned_.cells() + 1)) {
    return PlanStatus::out_of_memory;
  }
  planned_.find_cells(pool(), plan.list.data(), execution());
  return PlanStatus::unfinished;
}

void FlatGrid::sort_by_cell(const RowPlan& plan) noexcept {
  CountingSort sort({plan.list.data(), plan.rows}, {planned_start_.data(), planned_start_.size()},
                    execution());
  sort.count();
  if (drop_overfull(sort, plan)) sort.count();
  plan.regular.set_size(sort.find_starts());
  if (are_too_many_outside_cells(plan.objects - plan.regular.size(), plan))
    return move_all_to_rest(plan);
  sort.place(plan.regular.data());
  list_rest(plan.regular.size(), plan);
}

bool FlatGrid::drop_overfull(const CountingSort& sort, const RowPlan& plan) const noexcept {
  bool any = false;
  for (std::size_t cell = 0; cell < planned_.cells() && !any; ++cell) {
    any = sort.size_of(cell) > kOverfull;
  }
  if (!any) return false;
  for (std::uint32_t& cell : plan.list) {
    if (cell != CellLayout::kNoCell && sort.size_of(cell) > kOverfull) cell = CellLayout::kNoCell;
  }
  return true;
}

void FlatGrid::finish_build(const RowPlan&, bool) noexcept {
  layout_.swap(planned_);
  start_.swap(planned_start_);
}

bool FlatGrid::fits(std::size_t row, const ObjectBox& place) const noexcept {
  return layout_.fits(place, row, start_);
}

std::size_t FlatGrid::places() const noexcept {
  return std::size_t{layout_.axis(1).count} * layout_.axis(2).count;
}

std::uint32_t FlatGrid::first_row(std::uint32_t line) const noexcept {
  return start_[std::size_t{line} * layout_.axis(0).count];
}

std::size_t FlatGrid::write_misfits(std::uint32_t begin, std::uint32_t end,
                                    std::uint32_t* out) const noexcept {
  return flat_grid_kernels().find_misfits(view(), begin, end, out);
}

bool FlatGrid::find_pairs(std::uint32_t begin, std::uint32_t end, PairSink& sink) const noexcept {
  return flat_grid_kernels().self_pairs(view(), begin, end, sink);
}

bool FlatGrid::query(const QueryBatch& batch, PairSink& sink) const noexcept {
  return flat_grid_kernels().query(view(), batch, sink);
}

GridView FlatGrid::view() const noexcept {
  return {row_view(), start_.data(), {layout_.axis(0), layout_.axis(1), layout_.axis(2)}};
}

void FlatGrid::draw(DebugDraw& draw) const {
  draw_cells(draw, layout_, row_view(), start_, "runs fastest");
}

void FlatGrid::release_memory() noexcept {
  CellStructure::release_memory();
  layout_.release();
  planned_.release();
}

void FlatGrid::add_bytes(Footprint& footprint) const noexcept {
  CellStructure::add_bytes(footprint);
  footprint.structure += layout_.bytes();
  footprint.structure += planned_.bytes();
}

std::size_t FlatGrid::cells() const noexcept {
  return layout_.cells();
}

constexpr StructureCosts kCosts{.has_cells = true,
                                .frame = 5000,
                                .keep = 10,
                                .object = 8,
                                .level = 0.023,
                                .crowd = 2.8,
                                .pair = 3.2,
                                .moved = 430,
                                .rest = 0.4,
                                .build = 20,
                                .anew = 20,
                                .query_level = 36,
                                .rows = 1.5};
constexpr StructureInfo kInfo = structure_info<FlatGrid>("FlatGrid", &kCosts);

}  // namespace

StructureKind flat_grid() noexcept {
  return StructureKind(kInfo);
}

}  // namespace winnow
