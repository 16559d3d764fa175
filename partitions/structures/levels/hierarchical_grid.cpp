#include <winnow/partitions/debug_colours.h>
#include "core/sort/radix_sort.h"
#include "core/sort/stretches.h"
#include "partitions/structures/cells/cell_structure.h"
#include "partitions/structures/costs.h"
#include "partitions/structures/levels/hierarchical_grid.kernel.h"
#include "partitions/structures/levels/level_layout.h"

#include <algorithm>
#include <array>
#include <bit>

namespace winnow {

WINNOW_DEFINE_KERNELS(HierarchicalGridKernels, hierarchical_grid_kernels)
WINNOW_DEFINE_KERNELS(LevelRowsKernels, level_rows_kernels)

namespace {

constexpr std::size_t kFewest = 64;  // below this the tree alone does as well
// More objects than this in a cell, beyond what its line is cut into, are pruned better by the
// tree.
constexpr std::size_t kCrowd = 512;
// Objects for each cell of a line.
constexpr std::size_t kInCell = 4;
constexpr std::size_t kRowsPerStretch = 8192;
// Lines of a level that are looked up in a table: one for two objects, and so many.
constexpr std::size_t kMoreLines = 16;
// Rows behind those of the last level, and of each, up to the next whole block.
constexpr std::size_t kMostHoles = (kMostLevels + 1) * kBlockRows;

// One colour for each level, beside those of other things: from Okabe and Ito, as these, and darker
// from the sixth level on.
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

// Where a cell is. On an axis that is not divided it is drawn as long as what it holds.
Aabb cell_box(const GridLevel& g, const GridLine& line, std::uint32_t number, std::uint32_t cell,
              const Aabb& contents) noexcept {
  Aabb box = contents;
  const auto set = [&](const LevelAxis& axis, std::uint32_t from, std::uint32_t to) {
    if (axis.inverse == 0.0F) return;
    const auto a = static_cast<Eigen::Index>(axis.axis);
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
  const std::uint32_t from = line.first + (cell << line.shift);
  const std::uint32_t to = from + (1U << line.shift);
  const bool back = (number & 1U) != 0;
  set(g.fast, back ? g.steps + 1 - std::min(to, g.steps + 1) : from,
      back ? g.steps + 1 - from : to);
  return box;
}

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
class HierarchicalGrid final : public CellStructure {
 public:
  explicit HierarchicalGrid(const StructureInput& input) noexcept;

  /// Levels made by the last build, 0 if it made none.
  [[nodiscard]] std::size_t levels() const noexcept override {
    return regular_rows() == 0 ? 0 : level_count_;
  }

 private:
  [[nodiscard]] bool reserve(const BuildRoom& room) noexcept override;
  [[nodiscard]] std::size_t most_holes() const noexcept override { return kMostHoles; }
  [[nodiscard]] bool plan(const RowPlan& plan) noexcept override;
  void finish_build() noexcept override;
  [[nodiscard]] bool fits(std::size_t row) const noexcept override;
  [[nodiscard]] std::size_t places() const noexcept override { return line_.size(); }
  [[nodiscard]] std::uint32_t first_row(std::uint32_t line) const noexcept override {
    return start_[line_[line].cell];
  }
  std::size_t write_misfits(std::uint32_t begin, std::uint32_t end,
                            std::uint32_t* out) const noexcept override;
  [[nodiscard]] std::size_t pair_units() const noexcept override {
    return (regular_rows() + kBlockRows - 1) / kBlockRows;
  }
  bool find_pairs(std::uint32_t begin, std::uint32_t end, PairSink& sink) const noexcept override;
  bool query(const QueryBatch& batch, PairSink& sink) const noexcept override;
  void draw(DebugDraw& draw) const override;
  void release_memory() noexcept override;
  void add_bytes(Footprint& footprint) const noexcept override;
  [[nodiscard]] std::size_t cells() const noexcept override;

  struct Sorted;
  [[nodiscard]] std::span<const std::uint32_t> sort_by_level(const SizeClasses& classes,
                                                             std::span<std::uint32_t> start,
                                                             const RowPlan& plan) noexcept;
  bool build_level(std::span<const std::uint32_t> rows, const RowPlan& plan) noexcept;
  bool add_line(const Sorted& sorted, std::size_t begin, std::size_t end, const RowPlan& plan);
  static std::uint32_t leave_crowd(const RowPlan& plan, std::uint32_t begin,
                                   std::uint32_t end) noexcept;
  bool rank_lines(GridLevel& level);
  [[nodiscard]] std::uint32_t line_of(const GridLevel& level, std::size_t row) const noexcept;
  [[nodiscard]] LevelsView view() const noexcept;

  std::array<GridLevel, kMostLevels> level_;
  std::size_t level_count_ = 0;
  Column<GridLine> line_;
  Column<std::uint32_t> number_;  // of each line
  Column<std::uint32_t> rank_;    // lines below each number, level by level
  Column<float> key_;             // by row: lower end on the fast axis at the build
};

HierarchicalGrid::HierarchicalGrid(const StructureInput& input) noexcept
    : CellStructure(input),
      line_(input.memory),
      number_(input.memory),
      rank_(input.memory),
      key_(input.memory) {}

struct LinePlace {
  std::uint32_t line;
  std::uint32_t step;
};

LinePlace place_of(const GridLevel& g, const BoundsPool& pool, std::size_t row) noexcept {
  const std::uint32_t mid = cell_at(g.mid, pool.column(g.mid.axis)[row]);
  const std::uint32_t slow = cell_at(g.slow, pool.column(g.slow.axis)[row]);
  const std::uint32_t step = cell_at(g.fast, pool.column(g.fast.axis)[row]);
  const std::uint32_t line = line_number(g, mid, slow);
  return {line, (line & 1U) != 0 ? g.steps - step : step};
}

// Fewer are compared with each other sooner than a digit's values are counted.
constexpr std::size_t kFewToSort = 128;

/// Rows of a level in the order of their cells.
struct HierarchicalGrid::Sorted {
  const BoundsPool& pool;
  const GridLevel& level;
  const std::uint64_t* items = nullptr;
  std::size_t count = 0;
  unsigned step_bits = 0;
  bool packed = false;  ///< line and step fit in an item's upper half, else only the line does

  [[nodiscard]] std::uint32_t row(std::size_t i) const {
    return static_cast<std::uint32_t>(items[i]);
  }
  [[nodiscard]] std::uint32_t line(std::size_t i) const {
    const std::uint64_t key = items[i] >> 32U;
    return static_cast<std::uint32_t>(packed ? key >> step_bits : key);
  }
  [[nodiscard]] std::uint32_t step(std::size_t i) const {
    if (packed) return static_cast<std::uint32_t>(items[i] >> 32U) & level.steps;
    return place_of(level, pool, row(i)).step;
  }

  void sort(std::uint64_t* room, std::uint64_t* spare, std::span<const std::uint32_t> rows,
            const Execution& execution) {
    count = rows.size();
    step_bits = static_cast<unsigned>(std::bit_width(level.steps));
    const std::uint32_t last_line =
        level.mids * (static_cast<std::uint32_t>(level.slow.last) + 1) - 1;
    const auto line_bits = static_cast<unsigned>(std::bit_width(last_line));
    packed = line_bits + step_bits <= 32;
    for_stretches(execution, count, kRowsPerStretch, [&](std::size_t begin, std::size_t end) {
      level_rows_kernels().places(level, box_columns(pool).data(), rows.data(), begin, end,
                                  step_bits, !packed, room);
    });
    if (packed && count < kFewToSort) {
      std::sort(room, room + count);
      items = room;
      return;
    }
    const unsigned bits = packed ? line_bits + step_bits : step_bits;
    std::uint64_t* sorted = radix_sort(room, spare, count, bits, execution);
    if (!packed) {
      for (std::size_t i = 0; i < count; ++i) {
        const auto row_number = static_cast<std::uint32_t>(sorted[i]);
        const LinePlace place = place_of(level, pool, row_number);
        sorted[i] = std::uint64_t{place.line} << 32U | row_number;
      }
      sorted = radix_sort(sorted, sorted == room ? spare : room, count, line_bits, execution);
    }
    items = sorted;
  }
};

// Every object may have a line and a cell to itself; a level's table of lines has at most half as
// many entries as objects, and some more.
bool HierarchicalGrid::reserve(const BuildRoom& room) noexcept {
  const std::size_t objects = room.objects;
  return reserve_cells(room, objects, objects + kMostHoles) &&
         room.items.reserve(2 * objects, room.pages) &&
         key_.reserve(objects + kMostHoles, room.pages) && line_.reserve(objects, room.pages) &&
         number_.reserve(objects, room.pages) &&
         rank_.reserve(objects / 2 + kMostLevels * (kMoreLines + 1), room.pages);
}

bool HierarchicalGrid::plan(const RowPlan& plan) noexcept {
  const std::size_t rows = pool().rows();
  level_count_ = 0;
  // A first build meets no more rows than objects; of a scene in motion builds meet now more, now
  // fewer, and this is enough for mostly all.
  const std::size_t first = objects() + kMostHoles;
  const std::size_t later = std::max(rows, objects() + objects() / 8 + 256);
  if (!list_.reserve(rows <= first ? first : later)) return false;
  list_.set_size(rows);
  for_stretches(execution(), rows, kRowsPerStretch, [&](std::size_t begin, std::size_t end) {
    level_rows_kernels().octaves(box_columns(pool()).data(), begin, end, list_.data());
  });
  const SizeClasses classes(pool(), {list_.data(), rows}, execution());
  if (classes.objects() < kFewest) {
    leave_all(plan);
    return true;
  }
  // By objects, not rows, so that a later build of as many asks for no more.
  const std::size_t count = classes.objects();
  const std::size_t room = count + kMostHoles;
  if (!key_.reserve(room) || !plan.regular.reserve(room + kBlockRows) ||
      !plan.items.resize(2 * count)) {
    return false;
  }
  std::array<std::uint32_t, kMostLevels + 1> start{};
  const std::span<const std::uint32_t> by_level = sort_by_level(classes, start, plan);
  line_.clear();
  number_.clear();
  rank_.clear();
  start_.clear();
  for (std::size_t l = 0; l < classes.levels(); ++l) {
    if (!build_level(by_level.subspan(start[l], start[l + 1] - start[l]), plan)) return false;
  }
  key_.set_size(plan.regular.size() + kBlockRows);
  return start_.push_back(static_cast<std::uint32_t>(plan.regular.size()));
}

// Puts the rows of each level together, and where each begins into `start`. They lie at the end of
// the items, of which sorting a level needs two for each of its rows from the front, and for those
// of further levels leaves half of one.
std::span<const std::uint32_t> HierarchicalGrid::sort_by_level(const SizeClasses& classes,
                                                               std::span<std::uint32_t> start,
                                                               const RowPlan& plan) noexcept {
  std::array<std::uint32_t, kOctaves> level;
  for (std::uint32_t o = 0; o < kOctaves; ++o) {
    const std::size_t own = classes.level_of(o);
    level[o] = own < classes.levels() ? static_cast<std::uint32_t>(own) : CountingSort::kNone;
  }
  for_stretches(execution(), list_.size(), kRowsPerStretch,
                [&](std::size_t begin, std::size_t end) {
                  for (std::size_t row = begin; row < end; ++row) list_[row] = level[list_[row]];
                });
  CountingSort sort({list_.data(), list_.size()}, start.first(classes.levels() + 1),
                    {plan.rest.data(), plan.rest.capacity()}, execution());
  sort.count();
  const std::size_t count = sort.find_starts();
  auto* const by_level = reinterpret_cast<std::uint32_t*>(plan.items.end()) - count;
  sort.place(by_level);
  list_rest(count, plan);
  return {by_level, count};
}

bool HierarchicalGrid::build_level(std::span<const std::uint32_t> rows,
                                   const RowPlan& plan) noexcept {
  GridLevel& level = level_[level_count_];
  lay_level(pool(), rows, execution(), level);
  Sorted sorted{pool(), level};
  std::uint64_t* const room = plan.items.data();
  sorted.sort(room, room + plan.items.size() / 2, rows, execution());
  level.first_row = static_cast<std::uint32_t>(plan.regular.size());
  level.first_line = static_cast<std::uint32_t>(line_.size());
  std::size_t next = 0;
  for (std::size_t begin = 0; begin < sorted.count; begin = next) {
    next = begin + 1;
    while (next < sorted.count && sorted.line(next) == sorted.line(begin)) ++next;
    if (!add_line(sorted, begin, next, plan)) return false;
  }
  level.end_row = static_cast<std::uint32_t>(plan.regular.size());
  level.end_line = static_cast<std::uint32_t>(line_.size());
  if (level.end_row == level.first_row) return true;
  // No block of rows belongs to two levels.
  while (plan.regular.size() % kBlockRows != 0) {
    if (!plan.regular.push_back(kNoObject)) return false;
  }
  ++level_count_;
  return rank_lines(level);
}

// Rows [begin, end) are those of a cell: where they are too many the tree takes them. Returns where
// the next cell begins.
std::uint32_t HierarchicalGrid::leave_crowd(const RowPlan& plan, std::uint32_t begin,
                                            std::uint32_t end) noexcept {
  if (end - begin <= kCrowd) return end;
  for (std::uint32_t row = begin; row < end; ++row) {
    (void)plan.rest.push_back(plan.regular.data()[row]);
  }
  return begin;
}

// Cuts a line into cells of a few objects each, were they spread evenly.
bool HierarchicalGrid::add_line(const Sorted& sorted, std::size_t begin, std::size_t end,
                                const RowPlan& plan) {
  const std::size_t most = (end - begin + kInCell - 1) / kInCell;
  GridLine line;
  line.first = sorted.step(begin);
  line.cell = static_cast<std::uint32_t>(start_.size());
  const std::uint32_t length = sorted.step(end - 1) - line.first;
  while ((length >> line.shift) >= most) ++line.shift;
  line.last_cell = length >> line.shift;
  const std::size_t cells = std::size_t{line.last_cell} + 1;
  if (!start_.grow(start_.size() + cells)) return false;
  start_.set_size(start_.size() + cells);
  const std::size_t before = plan.regular.size();
  std::uint32_t* const start = start_.data() + line.cell;
  // Room for all was made.
  std::uint32_t* const rows = plan.regular.data();
  auto to = static_cast<std::uint32_t>(before);
  std::size_t next_cell = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t cell = (sorted.step(i) - line.first) >> line.shift;
    if (cell >= next_cell && next_cell != 0) to = leave_crowd(plan, start[next_cell - 1], to);
    while (next_cell <= cell) start[next_cell++] = to;
    rows[to++] = sorted.row(i);
  }
  to = leave_crowd(plan, start[next_cell - 1], to);
  plan.regular.set_size(to);
  if (plan.regular.size() == before) {
    start_.set_size(line.cell);
    return true;
  }
  return line_.push_back(line) && number_.push_back(sorted.line(begin));
}

// A table of all lines where they are not many more than the objects.
bool HierarchicalGrid::rank_lines(GridLevel& level) {
  const std::size_t lines =
      std::size_t{level.mids} * (static_cast<std::size_t>(level.slow.last) + 1);
  level.first_rank = static_cast<std::uint32_t>(rank_.size());
  level.ranked = lines <= (level.end_row - level.first_row) / 2 + kMoreLines;
  if (!level.ranked) return true;
  if (!rank_.resize(rank_.size() + lines + 1)) return false;
  std::uint32_t* const rank = rank_.data() + level.first_rank;
  std::size_t number = 0;
  for (std::uint32_t line = level.first_line; line < level.end_line; ++line) {
    while (number <= number_[line]) rank[number++] = line;
  }
  while (number <= lines) rank[number++] = level.end_line;
  return true;
}

void HierarchicalGrid::finish_build() noexcept {
  for (std::size_t l = 0; l < level_count_ && regular_rows() != 0; ++l) {
    const GridLevel& level = level_[l];
    const float* const low = pool().column(level.fast.axis);
    std::copy(low + level.first_row, low + level.end_row, key_.data() + level.first_row);
  }
}

// The stored line that holds a row of the level.
std::uint32_t HierarchicalGrid::line_of(const GridLevel& g, std::size_t row) const noexcept {
  const auto holds = [&](std::uint32_t line) {
    return row >= start_[line_[line].cell] &&
           row < start_[line_[line].cell + line_[line].last_cell + 1];
  };
  if (g.ranked) {
    // Mostly the box's own corner still lies in the line that holds the row.
    const std::uint32_t mid = cell_at(g.mid, pool().column(g.mid.axis)[row]);
    const std::uint32_t slow = cell_at(g.slow, pool().column(g.slow.axis)[row]);
    const std::uint32_t line = rank_[g.first_rank + line_number(g, mid, slow)];
    if (line < g.end_line && holds(line)) return line;
  }
  const auto after =
      std::partition_point(line_.begin() + g.first_line, line_.begin() + g.end_line,
                           [&](const GridLine& line) { return start_[line.cell] <= row; });
  return static_cast<std::uint32_t>(after - line_.begin()) - 1;
}

bool HierarchicalGrid::fits(std::size_t row) const noexcept {
  std::size_t l = 0;
  while (row >= level_[l].end_row) ++l;
  const GridLevel& g = level_[l];
  for (const LevelAxis* const axis : {&g.fast, &g.mid, &g.slow}) {
    const float edge = pool().column(3 + axis->axis)[row] - pool().column(axis->axis)[row];
    if (!(edge <= axis->limit)) return false;
  }
  const float low = pool().column(g.fast.axis)[row];
  if (!(low - g.fast.slack <= key_[row] && key_[row] <= low + g.fast.slack)) return false;
  const LineCells cells = cells_of_line(g, number_[line_of(g, row)]);
  const auto keeps = [&](const LevelAxis& axis, std::uint32_t cell) {
    const float x = pool().column(axis.axis)[row];
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
  return {row_view(),    level_.data(),  static_cast<std::uint32_t>(level_count_),
          line_.data(),  number_.data(), rank_.data(),
          start_.data(), key_.data()};
}

void HierarchicalGrid::draw(DebugDraw& draw) const {
  for (std::size_t l = 0; l < level_count_; ++l) {
    const GridLevel& g = level_[l];
    for (std::uint32_t i = g.first_line; i < g.end_line; ++i) {
      for (std::uint32_t cell = 0; cell <= line_[i].last_cell; ++cell) {
        Aabb contents;
        const std::uint32_t end = std::min(start_[line_[i].cell + cell + 1], g.end_row);
        for (std::uint32_t row = start_[line_[i].cell + cell]; row < end; ++row) {
          contents.merge(stored_box(row_view().column, row));
        }
        if (!contents.is_valid()) continue;  // nothing, or holes only
        draw.box(cell_box(g, line_[i], number_[i], cell, contents), level_colour(l));
        draw.box(contents, kContentsColour);
      }
    }
  }
}

void HierarchicalGrid::release_memory() noexcept {
  CellStructure::release_memory();
  release_columns(line_, number_, rank_, key_);
}

void HierarchicalGrid::add_bytes(Footprint& footprint) const noexcept {
  CellStructure::add_bytes(footprint);
  footprint.structure += bytes_of(line_, number_, rank_, key_);
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
                                .moved = 340,
                                .rest = 0.82,
                                .build = 56,
                                .ask = 40,
                                .ask_level = 24,
                                .rows = 1.0};
constexpr StructureInfo kInfo = structure_info<HierarchicalGrid>("HierarchicalGrid", &kCosts);

}  // namespace

StructureKind hierarchical_grid() noexcept {
  return StructureKind(kInfo);
}

}  // namespace winnow
