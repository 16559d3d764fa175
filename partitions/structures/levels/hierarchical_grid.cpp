// HierarchicalGrid: plans levels (size_classes.h, level_layout.h), sorts the rows of each level by
// line and cell, and dispatches to the kernels of hierarchical_grid.kernel.cpp.

#include <winnow/core/debug_draw.h>
#include "core/sort/parallel_ranges.h"
#include "core/sort/radix_sort.h"
#include "partitions/structures/cells/cell_structure.h"
#include "partitions/structures/costs.h"
#include "partitions/structures/levels/hierarchical_grid.kernel.h"
#include "partitions/structures/levels/level_layout.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <limits>
#include <utility>

namespace winnow {

WINNOW_DEFINE_KERNELS(HierarchicalGridKernels, hierarchical_grid_kernels)
WINNOW_DEFINE_KERNELS(LevelRowsKernels, level_rows_kernels)

namespace {

// If a cell contains more objects than this, the tree prunes them better.
constexpr std::size_t kCrowd = 512;
// Objects per cell of a line.
constexpr std::size_t kInCell = 4;
constexpr std::size_t kRowsPerRange = 8192;
constexpr std::size_t kLinesPerRange = 512;
// A level has a table of lines if the number of its lines is at most half the number of its objects
// plus this constant.
constexpr std::size_t kMoreLines = 16;
// Padding behind the rows of each level and of the last level, up to the next whole block.
constexpr std::size_t kMaxHoles = (kMaxLevels + 1) * kBlockRows;

// Returns the colour of a level. All differ from the other debug colours: five hues from the
// palette of Okabe and Ito, darker from the sixth level on.
Colour level_colour(std::size_t level) noexcept {
  constexpr std::array<Colour, 5> kHues{{kCellColour,
                                         {230, 159, 0, 255},
                                         {0, 158, 115, 255},
                                         {213, 94, 0, 255},
                                         {204, 121, 167, 255}}};
  const Colour hue = kHues[level % kHues.size()];
  const std::size_t left = 5 - level / kHues.size();
  const auto darker = [&](std::uint8_t c) { return static_cast<std::uint8_t>(c * left / 5); };
  return {darker(hue.r), darker(hue.g), darker(hue.b), hue.a};
}

/// Range of steps on the fast axis, inclusive.
struct StepRange {
  std::uint32_t first;
  std::uint32_t last;
};

// Returns the steps of a cell, counted from the low end of the axis. A line that runs backwards
// (`back`) stores steps counted from the high end.
StepRange steps_of_cell(const GridLevel& g, const GridLine& line, bool back,
                        std::uint32_t cell) noexcept {
  const std::uint32_t first = line.first + (cell << line.shift);
  const std::uint32_t last = std::min(g.steps, first + ((1U << line.shift) - 1));
  return back ? StepRange{g.steps - last, g.steps - first} : StepRange{first, last};
}

// The bounds of a cell. An axis that is not divided is drawn as long as the contents.
Aabb cell_box(const GridLevel& g, const GridLine& line, std::uint32_t number, std::uint32_t cell,
              const Aabb& contents) noexcept {
  Aabb box = contents;
  const auto set = [&](const LevelAxis& axis, std::uint32_t from, std::uint32_t to) {
    if (axis.inverse == 0.0F) return;
    const auto a = axis.axis;
    const auto edge = [&](std::uint32_t n) {
      return static_cast<float>(static_cast<double>(axis.origin) +
                                static_cast<double>(n) / static_cast<double>(axis.inverse));
    };
    box.min[a] = edge(from);
    box.max[a] = edge(to);
  };
  const LineCells at = cells_of_line(g, number);
  set(g.mid, at.mid, at.mid + 1);
  set(g.slow, at.slow, at.slow + 1);
  const StepRange steps = steps_of_cell(g, line, (number & 1U) != 0, cell);
  set(g.fast, steps.first, steps.last + 1);
  return box;
}

/// Returns the position nearest to x whose step is within the range. Returns NaN, which fails every
/// comparison, if floats are too coarse to find such a position.
float nearest_within(const LevelAxis& axis, const StepRange& steps, float x) noexcept {
  constexpr int kMaxTries = 4;
  const std::uint32_t step = cell_at(axis, x);
  const bool below = step < steps.first;
  if (!below && step <= steps.last) return x;
  const std::uint32_t edge = below ? steps.first : steps.last + 1;
  x = static_cast<float>(static_cast<double>(axis.origin) +
                         static_cast<double>(edge) / static_cast<double>(axis.inverse));
  const float inwards = below ? FLT_MAX : -FLT_MAX;
  for (int i = 0; i < kMaxTries; ++i) {
    const std::uint32_t own = cell_at(axis, x);
    if (own >= steps.first && own <= steps.last) return x;
    x = std::nextafter(x, inwards);
  }
  return std::numeric_limits<float>::quiet_NaN();
}

/// Uniform grids for ranges of sizes (Overmars, "Point location in fat subdivisions", Information
/// Processing Letters 44, 1992; Ericson, "Real-Time Collision Detection", 2005, 7.2), for scenes
/// with object sizes of up to 1e12 : 1. Each build decides from the numbers of objects of each size
/// which ranges of sizes are levels of their own; a scene with one size has one level. It needs no
/// parameter and no world bounds.
///
/// An object belongs to one cell: on its level, the cell of its box's lower corner. Cells form
/// lines. Only lines with objects are stored, and the cells of a line extend from its first object
/// to its last, so memory depends on the number of objects, not on the size of the world. Rows are
/// sorted by level, line and cell. Blocks of 16 consecutive rows are compact and search for
/// partners together, in their own level and in levels of larger objects, so each pair is found
/// once. Objects may drift from their cell by a slack, so slow scenes keep their order for many
/// frames.
///
/// Unbounded objects, objects of sizes beyond 1e12 : 1, and crowds that cells cannot separate go to
/// a block tree and query the levels. Self pairs: O(n log n + n * levels + pairs) for even density.
/// Exact. `statistics().cells` counts the cells of all levels.
class HierarchicalGrid final : public CellStructure {
 public:
  explicit HierarchicalGrid(const StructureInput& input) noexcept;

  /// The number of levels of the last build; 0 if it made none.
  [[nodiscard]] std::size_t levels() const noexcept override {
    return regular_rows() == 0 ? 0 : used_.levels;
  }

 private:
  [[nodiscard]] bool reserve(const BuildRoom& room) noexcept override;
  [[nodiscard]] std::size_t max_holes() const noexcept override { return kMaxHoles; }
  [[nodiscard]] PlanStatus plan(const RowPlan& plan, unsigned stage) noexcept override;
  [[nodiscard]] std::size_t plan_passes() const noexcept override { return 4; }
  void finish_build(const RowPlan& plan, bool foreseen) noexcept override;
  [[nodiscard]] bool fits(std::size_t row, const ObjectBox& place) const noexcept override;
  [[nodiscard]] std::size_t places() const noexcept override { return used_.line.size(); }
  [[nodiscard]] std::uint32_t first_row(std::uint32_t line) const noexcept override {
    return start_[used_.line[line].cell];
  }
  std::size_t write_misfits(std::uint32_t begin, std::uint32_t end,
                            std::uint32_t* out) const noexcept override;
  [[nodiscard]] std::size_t pair_units() const noexcept override {
    return blocks_of(regular_rows());
  }
  bool find_pairs(std::uint32_t begin, std::uint32_t end, PairSink& sink) const noexcept override;
  bool query(const QueryBatch& batch, PairSink& sink) const noexcept override;
  void draw(DebugDraw& draw) const override;
  void release_memory() noexcept override;
  void add_bytes(Footprint& footprint) const noexcept override;
  [[nodiscard]] std::size_t cells() const noexcept override;

  /// Levels and their lines.
  struct LevelLines {
    explicit LevelLines(std::pmr::memory_resource* memory) noexcept
        : level(memory), line(memory), number(memory), rank(memory) {}

    void clear() noexcept {
      levels = 0;
      level.clear();
      line.clear();
      number.clear();
      rank.clear();
    }
    void swap(LevelLines& other) noexcept {
      level.swap(other.level);
      std::swap(levels, other.levels);
      line.swap(other.line);
      number.swap(other.number);
      rank.swap(other.rank);
    }
    void release() noexcept { release_columns(level, line, number, rank); }
    [[nodiscard]] Bytes bytes() const noexcept { return bytes_of(level, line, number, rank); }

    Column<GridLevel> level;
    std::size_t levels = 0;  // levels that have rows; while planning, the finished ones
    Column<GridLine> line;
    Column<std::uint32_t> number;  // of each line
    Column<std::uint32_t> rank;    // by line number: the first stored line >= it
  };

  /// The rows of a level, sorted by cell. An item has the row in its low 32 bits and a key above.
  /// The key is line << step_bits | step or, if that exceeds 32 bits (not `packed`), only the line.
  struct SortedRows {
    const std::uint64_t* items = nullptr;
    std::size_t count = 0;
    unsigned line_bits = 0;
    unsigned step_bits = 0;
    bool packed = false;

    [[nodiscard]] std::uint32_t row(std::size_t i) const {
      return static_cast<std::uint32_t>(items[i]);
    }
    [[nodiscard]] std::uint32_t line(std::size_t i) const {
      const std::uint64_t key = items[i] >> 32U;
      return static_cast<std::uint32_t>(packed ? key >> step_bits : key);
    }
    /// Requires packed keys.
    [[nodiscard]] std::uint32_t step(std::size_t i) const {
      return static_cast<std::uint32_t>(items[i] >> 32U & ((std::uint64_t{1} << step_bits) - 1));
    }
  };

  [[nodiscard]] PlanStatus begin_plan(const RowPlan& plan) noexcept;
  template <typename T>
  [[nodiscard]] bool make_room(Column<T>& column, std::size_t count) noexcept;
  [[nodiscard]] bool add_spare_cells(std::size_t objects) noexcept;
  void sort_by_level(const SizeClasses& classes, const RowPlan& plan) noexcept;
  /// The steps of planning a level, in order.
  enum class PlanStep : std::uint8_t { places, sort, lines };
  [[nodiscard]] bool run_step(const RowPlan& plan) noexcept;
  [[nodiscard]] std::span<const std::uint32_t> rows_of_level(const RowPlan& plan) const noexcept;
  template <typename Visit>
  void visit_moved(const RowPlan& plan, Visit&& visit) const;
  void find_places(const RowPlan& plan) noexcept;
  void find_places_of_moved(const RowPlan& plan) noexcept;
  void sort_places(const RowPlan& plan) noexcept;
  [[nodiscard]] std::uint32_t step_of(const RowPlan& plan, std::size_t i) const noexcept;
  [[nodiscard]] bool lay_lines(const RowPlan& plan) noexcept;
  bool add_line(std::size_t begin, std::size_t end, const RowPlan& plan);
  void fill_cells(std::span<std::uint32_t> start, const GridLine& line, std::size_t begin,
                  std::size_t end, const RowPlan& plan) noexcept;
  static void move_crowds_to_rest(std::span<std::uint32_t> start, const RowPlan& plan) noexcept;
  bool rank_lines(GridLevel& level);
  void clamp_keys_to_cells(std::uint32_t begin, std::uint32_t end) noexcept;
  [[nodiscard]] std::uint32_t line_of(const GridLevel& level, const ObjectBox& place,
                                      std::size_t row) const noexcept;
  [[nodiscard]] LevelsView view() const noexcept;

  LevelLines used_;
  LevelLines planned_;
  // By row: the object's lower bound on the fast axis at the build, clamped to the row's cell.
  Column<float> key_;

  // While planning: the first row of each level, and the progress of the plan.
  std::array<std::uint32_t, kMaxLevels + 1> first_of_level_{};
  std::size_t all_levels_ = 0;
  std::size_t level_ = 0;
  PlanStep step_ = PlanStep::places;
  bool grew_ = false;  // columns of lines and cells grew since the last finished plan
  SortedRows sorted_;
};

HierarchicalGrid::HierarchicalGrid(const StructureInput& input) noexcept
    : CellStructure(input), used_(input.memory), planned_(input.memory), key_(input.memory) {}

struct LinePlace {
  std::uint32_t line;
  std::uint32_t step;
};

LinePlace place_on(const GridLevel& g, const Structure::ObjectBox& box) noexcept {
  const std::uint32_t mid = cell_at(g.mid, box.low[g.mid.axis]);
  const std::uint32_t slow = cell_at(g.slow, box.low[g.slow.axis]);
  const std::uint32_t step = cell_at(g.fast, box.low[g.fast.axis]);
  const std::uint32_t line = line_number(g, mid, slow);
  return {line, (line & 1U) != 0 ? g.steps - step : step};
}

// With fewer items a comparison sort is faster than a radix sort.
constexpr std::size_t kFewToSort = 128;

// A level's table of lines has at most half as many entries as objects, plus a constant.
constexpr std::size_t max_ranks(std::size_t objects) noexcept {
  return objects / 2 + kMaxLevels * (kMoreLines + 1);
}

// Every object may have its own line and cell.
bool HierarchicalGrid::reserve(const BuildRoom& room) noexcept {
  const std::size_t objects = room.objects;
  return reserve_cells(room, objects, objects + kMaxHoles) &&
         room.items.reserve(2 * objects, room.pages) &&
         key_.reserve(objects + kMaxHoles, room.pages) &&
         planned_.level.reserve(kMaxLevels, room.pages) &&
         planned_.line.reserve(objects, room.pages) &&
         planned_.number.reserve(objects, room.pages) &&
         planned_.rank.reserve(max_ranks(objects), room.pages);
}

PlanStatus HierarchicalGrid::plan(const RowPlan& plan, unsigned stage) noexcept {
  if (stage == 0) return begin_plan(plan);
  // Runs steps of levels that take about as long as one pass over all rows.
  for (std::size_t rows = 0; level_ < all_levels_ && 2 * rows < plan.objects;) {
    rows += rows_of_level(plan).size();
    if (!run_step(plan)) return PlanStatus::out_of_memory;
  }
  if (level_ < all_levels_) return PlanStatus::unfinished;
  key_.set_size(plan.regular.size() + kBlockRows);
  if (!make_room(planned_start_, planned_start_.size() + 1) || !add_spare_cells(plan.objects)) {
    return PlanStatus::out_of_memory;
  }
  (void)planned_start_.push_back(static_cast<std::uint32_t>(plan.regular.size()));
  return PlanStatus::done;
}

// Makes room for `count` elements; sets grew_ if this allocates memory.
template <typename T>
bool HierarchicalGrid::make_room(Column<T>& column, std::size_t count) noexcept {
  if (count <= column.capacity()) return true;
  grew_ = true;
  return column.grow(count);
}

// Reserves room for more lines and cells in later builds: their number varies in a moving scene.
bool HierarchicalGrid::add_spare_cells(std::size_t objects) noexcept {
  if (!std::exchange(grew_, false)) return true;
  const auto leave = [](auto& column, std::size_t most) {
    const std::size_t size = column.size();
    return column.reserve(std::min(most, size + size / 4 + 64));
  };
  return leave(planned_start_, objects + 1) && leave(planned_.line, objects) &&
         leave(planned_.number, objects) && leave(planned_.rank, max_ranks(objects));
}

PlanStatus HierarchicalGrid::begin_plan(const RowPlan& plan) noexcept {
  const std::size_t rows = plan.rows;
  planned_.clear();
  planned_start_.clear();
  // The first build has no more rows than objects. Later builds of a moving scene have a varying
  // number of rows; `later` is enough for nearly all of them.
  const std::size_t first = plan.objects + kMaxHoles;
  const std::size_t later = std::max(rows, plan.objects + plan.objects / 8 + 256);
  if (!plan.list.reserve(rows <= first ? first : later)) return PlanStatus::out_of_memory;
  plan.list.set_size(rows);
  for_each_even_range(execution(), rows, kRowsPerRange, [&](std::size_t begin, std::size_t end) {
    level_rows_kernels().octaves(box_columns(pool()).data(), begin, end, plan.list.data());
  });
  const SizeClasses classes(pool(), {plan.list.data(), rows}, execution());
  if (classes.objects() < kMinInCells) {
    append_all_to_rest(plan);
    return PlanStatus::done;
  }
  // Columns are sized by objects, not rows, so that a later build of as many objects does not
  // allocate.
  const std::size_t count = classes.objects();
  const std::size_t room = count + kMaxHoles;
  if (!key_.reserve(room) || !plan.regular.reserve(room + kBlockRows) ||
      !plan.items.resize(2 * count) || !planned_.level.reserve(kMaxLevels)) {
    return PlanStatus::out_of_memory;
  }
  sort_by_level(classes, plan);
  level_ = 0;
  step_ = PlanStep::places;
  return PlanStatus::unfinished;
}

// Groups the rows by level, at the end of `items`. Sorting a level overwrites at most the rows of
// this level and of earlier levels.
void HierarchicalGrid::sort_by_level(const SizeClasses& classes, const RowPlan& plan) noexcept {
  all_levels_ = classes.levels();
  planned_.level.set_size(all_levels_);
  std::array<std::uint32_t, kOctaves> level;
  for (std::uint32_t o = 0; o < kOctaves; ++o) {
    const std::size_t own = classes.level_of(o);
    level[o] = own < all_levels_ ? static_cast<std::uint32_t>(own) : CountingSort::kNone;
  }
  Column<std::uint32_t>& list = plan.list;
  for_each_even_range(execution(), list.size(), kRowsPerRange,
                      [&](std::size_t begin, std::size_t end) {
                        for (std::size_t row = begin; row < end; ++row)
                          list[row] = level[list[row]];
                      });
  CountingSort sort({list.data(), list.size()}, std::span(first_of_level_).first(all_levels_ + 1),
                    execution());
  sort.count();
  const std::size_t count = sort.find_starts();
  sort.place(reinterpret_cast<std::uint32_t*>(plan.items.end()) - count);
  list_rest(count, plan);
}

std::span<const std::uint32_t> HierarchicalGrid::rows_of_level(const RowPlan& plan) const noexcept {
  const std::uint32_t begin = first_of_level_[level_];
  const std::uint32_t all = first_of_level_[all_levels_];
  const auto* const by_level = reinterpret_cast<const std::uint32_t*>(plan.items.end()) - all;
  return {by_level + begin, first_of_level_[level_ + 1] - begin};
}

// Returns false if an allocation fails.
bool HierarchicalGrid::run_step(const RowPlan& plan) noexcept {
  switch (step_) {
    case PlanStep::places:
      find_places(plan);
      step_ = PlanStep::sort;
      // Sorting with unpacked keys reads positions again, so it must run before any object moves.
      if (!sorted_.packed) sort_places(plan);
      return sorted_.packed || lay_lines(plan);
    case PlanStep::sort:
      sort_places(plan);
      step_ = PlanStep::lines;
      return true;
    case PlanStep::lines:
      return lay_lines(plan);
  }
  return false;
}

// Calls visit(i, where) for each row i of the level whose object was moved to row `where`.
template <typename Visit>
void HierarchicalGrid::visit_moved(const RowPlan& plan, Visit&& visit) const {
  const std::span<const std::uint32_t> rows = rows_of_level(plan);
  for (const RowMove& move : plan.moves) {
    const auto at = std::ranges::lower_bound(rows, move.row);
    if (at == rows.end() || *at != move.row) continue;
    const std::size_t now = current_row(plan, move.row);
    if (now != move.row) visit(static_cast<std::size_t>(at - rows.begin()), now);
  }
}

void HierarchicalGrid::find_places(const RowPlan& plan) noexcept {
  const std::span<const std::uint32_t> rows = rows_of_level(plan);
  GridLevel& level = planned_.level[planned_.levels];
  level = {};
  std::array<float, 3> longest{};
  visit_moved(plan, [&](std::size_t, std::size_t row) {
    for (std::size_t a = 0; a < 3; ++a) {
      longest[a] = std::max(longest[a], pool().column(3 + a)[row] - pool().column(a)[row]);
    }
  });
  lay_level(pool(), rows, longest, execution(), level);
  const std::uint32_t last_line =
      level.mids * (static_cast<std::uint32_t>(level.slow.last) + 1) - 1;
  sorted_ = {.count = rows.size(),
             .line_bits = static_cast<unsigned>(std::bit_width(last_line)),
             .step_bits = static_cast<unsigned>(std::bit_width(level.steps))};
  sorted_.packed = sorted_.line_bits + sorted_.step_bits <= 32;
  for_each_even_range(
      execution(), rows.size(), kRowsPerRange, [&](std::size_t begin, std::size_t end) {
        level_rows_kernels().places(level, box_columns(pool()).data(), rows.data(), begin, end,
                                    sorted_.step_bits, !sorted_.packed, plan.items.data());
      });
  find_places_of_moved(plan);
}

// A row that has become empty gets the cell of the object that was moved out of it.
void HierarchicalGrid::find_places_of_moved(const RowPlan& plan) noexcept {
  const std::span<const std::uint32_t> rows = rows_of_level(plan);
  visit_moved(plan, [&](std::size_t i, std::size_t row) {
    const LinePlace at = place_on(planned_.level[planned_.levels], box_of_row(row));
    const std::uint32_t line = sorted_.packed ? at.line << sorted_.step_bits : 0;
    plan.items[i] = std::uint64_t{line | at.step} << 32U | rows[i];
  });
}

void HierarchicalGrid::sort_places(const RowPlan& plan) noexcept {
  std::uint64_t* const room = plan.items.data();
  std::uint64_t* const spare = room + plan.items.size() / 2;
  SortedRows& own = sorted_;
  if (own.packed && own.count < kFewToSort) {
    std::sort(room, room + own.count);
    own.items = room;
    return;
  }
  const unsigned bits = own.packed ? own.line_bits + own.step_bits : own.step_bits;
  std::uint64_t* sorted = radix_sort(room, spare, own.count, bits, execution());
  if (!own.packed) {
    for (std::size_t i = 0; i < own.count; ++i) {
      const auto row = static_cast<std::uint32_t>(sorted[i]);
      const ObjectBox place = box_of_row(current_row(plan, row));
      const std::uint32_t line = place_on(planned_.level[planned_.levels], place).line;
      sorted[i] = std::uint64_t{line} << 32U | row;
    }
    sorted =
        radix_sort(sorted, sorted == room ? spare : room, own.count, own.line_bits, execution());
  }
  own.items = sorted;
}

std::uint32_t HierarchicalGrid::step_of(const RowPlan& plan, std::size_t i) const noexcept {
  if (sorted_.packed) return sorted_.step(i);
  const GridLevel& level = planned_.level[planned_.levels];
  return place_on(level, box_of_row(current_row(plan, sorted_.row(i)))).step;
}

bool HierarchicalGrid::lay_lines(const RowPlan& plan) noexcept {
  GridLevel& level = planned_.level[planned_.levels];
  level.first_row = static_cast<std::uint32_t>(plan.regular.size());
  level.first_line = static_cast<std::uint32_t>(planned_.line.size());
  std::size_t next = 0;
  for (std::size_t begin = 0; begin < sorted_.count; begin = next) {
    next = begin + 1;
    while (next < sorted_.count && sorted_.line(next) == sorted_.line(begin)) ++next;
    if (!add_line(begin, next, plan)) return false;
  }
  level.end_row = static_cast<std::uint32_t>(plan.regular.size());
  level.end_line = static_cast<std::uint32_t>(planned_.line.size());
  ++level_;
  step_ = PlanStep::places;
  if (level.end_row == level.first_row) return true;
  // No block of rows belongs to two levels.
  while (plan.regular.size() % kBlockRows != 0) {
    if (!plan.regular.push_back(kNoObject)) return false;
  }
  ++planned_.levels;
  return rank_lines(level);
}

// Divides a line into cells that would have kInCell objects each if objects were spread evenly.
bool HierarchicalGrid::add_line(std::size_t begin, std::size_t end, const RowPlan& plan) {
  const std::size_t most = (end - begin + kInCell - 1) / kInCell;
  Column<std::uint32_t>& starts = planned_start_;
  GridLine line;
  line.first = step_of(plan, begin);
  line.cell = static_cast<std::uint32_t>(starts.size());
  const std::uint32_t length = step_of(plan, end - 1) - line.first;
  while ((length >> line.shift) >= most) ++line.shift;
  line.last_cell = length >> line.shift;
  const std::size_t cells = std::size_t{line.last_cell} + 1;
  if (!make_room(starts, starts.size() + cells)) return false;
  starts.set_size(starts.size() + cells);
  const std::size_t before = plan.regular.size();
  fill_cells({starts.data() + line.cell, cells}, line, begin, end, plan);
  if (plan.regular.size() == before) {
    starts.set_size(line.cell);
    return true;
  }
  const std::size_t lines = planned_.line.size() + 1;
  if (!make_room(planned_.line, lines) || !make_room(planned_.number, lines)) return false;
  return planned_.line.push_back(line) && planned_.number.push_back(sorted_.line(begin));
}

// Appends the rows of a line, which are in the order of cells, and writes the first row of each
// cell, without branches because the ends of cells are unpredictable.
void HierarchicalGrid::fill_cells(std::span<std::uint32_t> start, const GridLine& line,
                                  std::size_t begin, std::size_t end,
                                  const RowPlan& plan) noexcept {
  std::ranges::fill(start, ~0U);
  const auto first = static_cast<std::uint32_t>(plan.regular.size());
  // A copy: writes to `start` could alias the member.
  const SortedRows sorted = sorted_;
  const auto note = [start, first, begin, end, line](auto&& step_at) {
    for (std::size_t i = end; i-- > begin;) {
      start[(step_at(i) - line.first) >> line.shift] =
          first + static_cast<std::uint32_t>(i - begin);
    }
  };
  if (sorted.packed) {
    note([sorted](std::size_t i) { return sorted.step(i); });
  } else {
    note([&](std::size_t i) { return step_of(plan, i); });
  }
  const auto behind = first + static_cast<std::uint32_t>(end - begin);
  std::uint32_t most = 0;
  std::uint32_t next = behind;
  for (std::size_t cell = start.size(); cell-- > 0;) {
    start[cell] = std::min(start[cell], next);
    most = std::max(most, next - start[cell]);
    next = start[cell];
  }
  // Room for all rows was reserved.
  std::uint32_t* const rows = plan.regular.data() + first;
  for (std::size_t i = begin; i < end; ++i) rows[i - begin] = sorted.row(i);
  plan.regular.set_size(behind);
  if (most > kCrowd) move_crowds_to_rest(start, plan);
}

// Moves the rows of overfull cells of a line to the rest. The rows of this line are the last ones.
void HierarchicalGrid::move_crowds_to_rest(std::span<std::uint32_t> start,
                                           const RowPlan& plan) noexcept {
  std::uint32_t* const rows = plan.regular.data();
  const auto behind = static_cast<std::uint32_t>(plan.regular.size());
  std::uint32_t to = start.front();
  for (std::size_t c = 0; c < start.size(); ++c) {
    std::uint32_t row = std::exchange(start[c], to);
    const std::uint32_t last = c + 1 < start.size() ? start[c + 1] : behind;
    const bool crowd = last - row > kCrowd;
    for (; row < last; ++row) {
      if (crowd) {
        (void)plan.rest.push_back(rows[row]);
      } else {
        rows[to++] = rows[row];
      }
    }
  }
  plan.regular.set_size(to);
}

// Builds a table of all lines of a level if their number is at most half the number of objects,
// plus kMoreLines.
bool HierarchicalGrid::rank_lines(GridLevel& level) {
  const std::size_t lines =
      std::size_t{level.mids} * (static_cast<std::size_t>(level.slow.last) + 1);
  Column<std::uint32_t>& ranks = planned_.rank;
  level.first_rank = static_cast<std::uint32_t>(ranks.size());
  level.ranked = lines <= (level.end_row - level.first_row) / 2 + kMoreLines;
  if (!level.ranked) return true;
  if (!make_room(ranks, ranks.size() + lines + 1)) return false;
  ranks.set_size(ranks.size() + lines + 1);
  std::uint32_t* const rank = ranks.data() + level.first_rank;
  std::size_t number = 0;
  for (std::uint32_t line = level.first_line; line < level.end_line; ++line) {
    while (number <= planned_.number[line]) rank[number++] = line;
  }
  while (number <= lines) rank[number++] = level.end_line;
  return true;
}

void HierarchicalGrid::finish_build(const RowPlan&, bool moved) noexcept {
  used_.swap(planned_);
  start_.swap(planned_start_);
  for (std::size_t l = 0; l < used_.levels && regular_rows() != 0; ++l) {
    const GridLevel& level = used_.level[l];
    const float* const low = pool().column(level.fast.axis);
    std::copy(low + level.first_row, low + level.end_row, key_.data() + level.first_row);
  }
  if (!moved || regular_rows() == 0) return;
  for_each_range(
      execution(), used_.line.size(), kLinesPerRange, [&](std::size_t begin, std::size_t end) {
        clamp_keys_to_cells(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
      });
}

// Objects may have moved since they were assigned to cells. A key outside its cell becomes the
// nearest position within the cell, so that an object near its key is near its cell.
void HierarchicalGrid::clamp_keys_to_cells(std::uint32_t begin, std::uint32_t end) noexcept {
  const GridLevel* level = used_.level.data();
  for (std::uint32_t l = begin; l < end; ++l) {
    while (l >= level->end_line) ++level;
    const GridLine& line = used_.line[l];
    const bool back = (used_.number[l] & 1U) != 0;
    for (std::uint32_t cell = 0; cell <= line.last_cell; ++cell) {
      const StepRange own = steps_of_cell(*level, line, back, cell);
      // Rows between two levels have no objects.
      const std::uint32_t end_row = std::min(start_[line.cell + cell + 1], level->end_row);
      for (std::uint32_t row = start_[line.cell + cell]; row < end_row; ++row) {
        key_[row] = nearest_within(level->fast, own, key_[row]);
      }
    }
  }
}

// Returns the stored line that contains a row of the level; the object of this row is at `place`.
std::uint32_t HierarchicalGrid::line_of(const GridLevel& g, const ObjectBox& place,
                                        std::size_t row) const noexcept {
  const Column<GridLine>& lines = used_.line;
  const auto contains_row = [&](std::uint32_t line) {
    return row >= start_[lines[line].cell] &&
           row < start_[lines[line].cell + lines[line].last_cell + 1];
  };
  if (g.ranked) {
    // Usually the box's lower corner is still in the line that contains the row.
    const std::uint32_t line = used_.rank[g.first_rank + place_on(g, place).line];
    if (line < g.end_line && contains_row(line)) return line;
  }
  const auto after =
      std::partition_point(lines.begin() + g.first_line, lines.begin() + g.end_line,
                           [&](const GridLine& line) { return start_[line.cell] <= row; });
  return static_cast<std::uint32_t>(after - lines.begin()) - 1;
}

bool HierarchicalGrid::fits(std::size_t row, const ObjectBox& place) const noexcept {
  std::size_t l = 0;
  while (row >= used_.level[l].end_row) ++l;
  const GridLevel& g = used_.level[l];
  for (const LevelAxis* const axis : {&g.fast, &g.mid, &g.slow}) {
    if (!(place.high[axis->axis] - place.low[axis->axis] <= axis->limit)) return false;
  }
  const float low = place.low[g.fast.axis];
  if (!(low - g.fast.slack <= key_[row] && key_[row] <= low + g.fast.slack)) return false;
  const LineCells cells = cells_of_line(g, used_.number[line_of(g, place, row)]);
  const auto keeps = [&](const LevelAxis& axis, std::uint32_t cell) {
    const float x = place.low[axis.axis];
    return cell_at(axis, x - axis.slack) <= cell && cell <= cell_at(axis, x + axis.slack);
  };
  return keeps(g.mid, cells.mid) && keeps(g.slow, cells.slow);
}

std::size_t HierarchicalGrid::write_misfits(std::uint32_t begin, std::uint32_t end,
                                            std::uint32_t* out) const noexcept {
  return hierarchical_grid_kernels().find_misfits(view(), begin, end, out);
}

bool HierarchicalGrid::find_pairs(std::uint32_t begin, std::uint32_t end,
                                  PairSink& sink) const noexcept {
  return hierarchical_grid_kernels().self_pairs(view(), begin, end, sink);
}

bool HierarchicalGrid::query(const QueryBatch& batch, PairSink& sink) const noexcept {
  return hierarchical_grid_kernels().query(view(), batch, sink);
}

LevelsView HierarchicalGrid::view() const noexcept {
  return {row_view(),        used_.level.data(),  static_cast<std::uint32_t>(used_.levels),
          used_.line.data(), used_.number.data(), used_.rank.data(),
          start_.data(),     key_.data()};
}

void HierarchicalGrid::draw(DebugDraw& draw) const {
  const Column<GridLine>& lines = used_.line;
  for (std::size_t l = 0; l < used_.levels; ++l) {
    const GridLevel& g = used_.level[l];
    for (std::uint32_t i = g.first_line; i < g.end_line; ++i) {
      for (std::uint32_t cell = 0; cell <= lines[i].last_cell; ++cell) {
        Aabb contents;
        const std::uint32_t end = std::min(start_[lines[i].cell + cell + 1], g.end_row);
        for (std::uint32_t row = start_[lines[i].cell + cell]; row < end; ++row) {
          contents.merge(stored_box(row_view().column, row));
        }
        if (!contents.is_valid()) continue;  // empty, or only holes
        draw.box(cell_box(g, lines[i], used_.number[i], cell, contents), level_colour(l));
        draw.box(contents, kContentsColour);
      }
    }
  }
}

void HierarchicalGrid::release_memory() noexcept {
  CellStructure::release_memory();
  used_.release();
  planned_.release();
  key_.release();
}

void HierarchicalGrid::add_bytes(Footprint& footprint) const noexcept {
  CellStructure::add_bytes(footprint);
  footprint.structure += used_.bytes();
  footprint.structure += planned_.bytes();
  footprint.structure += key_.bytes();
}

std::size_t HierarchicalGrid::cells() const noexcept {
  return start_.empty() ? 0 : start_.size() - 1;
}

constexpr StructureCosts kCosts{.has_cells = true,
                                .frame = 22,
                                .keep = 13.2,
                                .object = 3.8,
                                .crowd = 2.2,
                                .pair = 5.5,
                                .moved = 430,
                                .rest = 0.4,
                                .build = 56,
                                .anew = 37,
                                .query = 40,
                                .query_level = 24,
                                .rows = 1.0};
constexpr StructureInfo kInfo = structure_info<HierarchicalGrid>("HierarchicalGrid", &kCosts);

}  // namespace

StructureKind hierarchical_grid() noexcept {
  return StructureKind(kInfo);
}

}  // namespace winnow
