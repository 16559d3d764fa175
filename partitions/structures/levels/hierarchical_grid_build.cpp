// HierarchicalGrid: how rows are put in order.

#include "core/sort/radix_sort.h"
#include "partitions/structures/levels/hierarchical_grid.h"

#include <algorithm>
#include <bit>

namespace winnow {
namespace {

constexpr std::size_t kBlock = BoundsPool::kBlock;
constexpr std::size_t kFewest = 64;  // below this the tree alone does as well
// More objects than this in a cell, beyond what its line is cut into, are pruned better by the
// tree.
constexpr std::size_t kCrowd = 512;
// Objects for each cell of a line.
constexpr std::size_t kInCell = 4;

struct Place {
  std::uint32_t line;
  std::uint32_t step;
};

Place place_of(const GridLevel& g, const BoundsPool& pool, std::size_t row) noexcept {
  const std::uint32_t mid = cell_at(g.mid, pool.column(g.mid.axis)[row]);
  const std::uint32_t slow = cell_at(g.slow, pool.column(g.slow.axis)[row]);
  const std::uint32_t step = cell_at(g.fast, pool.column(g.fast.axis)[row]);
  const std::uint32_t line = line_number(g, mid, slow);
  return {line, (line & 1U) != 0 ? g.steps - step : step};
}

}  // namespace

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
    for (std::size_t i = 0; i < count; ++i) {
      const Place place = place_of(level, pool, rows[i]);
      const std::uint64_t key =
          packed ? std::uint64_t{place.line} << step_bits | place.step : place.step;
      room[i] = key << 32U | rows[i];
    }
    if (packed && count < 1024) {
      std::sort(room, room + count);
      items = room;
      return;
    }
    const unsigned bits = packed ? line_bits + step_bits : step_bits;
    std::uint64_t* sorted = radix_sort(room, spare, count, bits, execution);
    if (!packed) {
      for (std::size_t i = 0; i < count; ++i) {
        const auto row_number = static_cast<std::uint32_t>(sorted[i]);
        const Place place = place_of(level, pool, row_number);
        sorted[i] = std::uint64_t{place.line} << 32U | row_number;
      }
      sorted = radix_sort(sorted, sorted == room ? spare : room, count, line_bits, execution);
    }
    items = sorted;
  }
};

bool HierarchicalGrid::plan(Column<std::uint32_t>& regular, Column<std::uint32_t>& rest) {
  const SizeClasses classes(pool());
  level_count_ = 0;
  if (classes.objects() < kFewest) return RowPartition::plan(regular, rest);
  // By objects, not rows, so that a later build of as many asks for no more.
  const std::size_t objects = classes.objects();
  const std::size_t room = objects + (kMostLevels + 1) * kBlock;
  if (!list_.reserve(room) || !key_.reserve(room) || !regular.reserve(room + kBlock) ||
      !sort_scratch().resize(2 * objects)) {
    return false;
  }
  list_.set_size(objects);
  std::array<std::uint32_t, kMostLevels + 1> end{};
  sort_by_level(classes, end, rest);
  line_.clear();
  number_.clear();
  rank_.clear();
  start_.clear();
  std::uint32_t begin = 0;
  for (std::size_t l = 0; l < classes.levels(); ++l) {
    const std::span<const std::uint32_t> own(list_.data() + begin, end[l] - begin);
    begin = end[l];
    if (!build_level(own, regular, rest)) return false;
  }
  key_.set_size(regular.size() + kBlock);
  return start_.push_back(static_cast<std::uint32_t>(regular.size()));
}

// Puts the rows of each level together in list_, and where each ends into `end`.
void HierarchicalGrid::sort_by_level(const SizeClasses& classes, std::span<std::uint32_t> end,
                                     Column<std::uint32_t>& rest) noexcept {
  const std::size_t rows = pool().rows();
  std::array<std::uint32_t, kMostLevels + 2> at{};
  for (std::size_t row = 0; row < rows; ++row) {
    if (pool().ids()[row] != kNoObject) ++at[classes.level_of(longest_edge(pool(), row)) + 1];
  }
  for (std::size_t l = 0; l < classes.levels(); ++l) at[l + 1] += at[l];
  for (std::size_t row = 0; row < rows; ++row) {
    if (pool().ids()[row] == kNoObject) continue;
    const std::size_t level = classes.level_of(longest_edge(pool(), row));
    if (level == classes.levels()) {
      (void)rest.push_back(static_cast<std::uint32_t>(row));
    } else {
      list_[at[level]++] = static_cast<std::uint32_t>(row);
    }
  }
  std::copy_n(at.begin(), classes.levels(), end.begin());
}

bool HierarchicalGrid::build_level(std::span<const std::uint32_t> rows,
                                   Column<std::uint32_t>& regular, Column<std::uint32_t>& rest) {
  GridLevel& level = level_[level_count_];
  lay_level(pool(), rows, level);
  Sorted sorted{pool(), level};
  std::uint64_t* const room = sort_scratch().data();
  sorted.sort(room, room + sort_scratch().size() / 2, rows, execution());
  level.first_row = static_cast<std::uint32_t>(regular.size());
  level.first_line = static_cast<std::uint32_t>(line_.size());
  std::size_t next = 0;
  for (std::size_t begin = 0; begin < sorted.count; begin = next) {
    next = begin + 1;
    while (next < sorted.count && sorted.line(next) == sorted.line(begin)) ++next;
    if (!add_line(sorted, begin, next, regular, rest)) return false;
  }
  level.end_row = static_cast<std::uint32_t>(regular.size());
  level.end_line = static_cast<std::uint32_t>(line_.size());
  if (level.end_row == level.first_row) return true;
  // No block of rows belongs to two levels.
  while (regular.size() % kBlock != 0) {
    if (!regular.push_back(kNoObject)) return false;
  }
  ++level_count_;
  return rank_lines(level);
}

// Cuts a line into cells of a few objects each, were they spread evenly.
bool HierarchicalGrid::add_line(const Sorted& sorted, std::size_t begin, std::size_t end,
                                Column<std::uint32_t>& regular, Column<std::uint32_t>& rest) {
  const std::size_t most = (end - begin + kInCell - 1) / kInCell;
  GridLine line;
  line.first = sorted.step(begin);
  line.cell = static_cast<std::uint32_t>(start_.size());
  const std::uint32_t length = sorted.step(end - 1) - line.first;
  while ((length >> line.shift) >= most) ++line.shift;
  line.last_cell = length >> line.shift;
  if (!start_.grow(start_.size() + line.last_cell + 1)) return false;
  const std::size_t before = regular.size();
  std::uint32_t cells = 0;
  std::size_t next = 0;
  for (std::size_t i = begin; i < end; i = next) {
    const std::uint32_t cell = (sorted.step(i) - line.first) >> line.shift;
    next = i + 1;
    while (next < end && (sorted.step(next) - line.first) >> line.shift == cell) ++next;
    for (; cells <= cell; ++cells) {
      (void)start_.push_back(static_cast<std::uint32_t>(regular.size()));
    }
    Column<std::uint32_t>& to = next - i > kCrowd ? rest : regular;
    for (std::size_t k = i; k < next; ++k) (void)to.push_back(sorted.row(k));
  }
  if (regular.size() == before) {
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
  level.ranked = lines <= (level.end_row - level.first_row) / 2 + 16;
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

}  // namespace winnow
