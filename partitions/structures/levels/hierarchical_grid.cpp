#include "partitions/structures/levels/hierarchical_grid.h"

#include <winnow/partitions/debug_colours.h>
#include "partitions/structures/cells/cell_drawing.h"
#include "partitions/structures/cells/task_lists.h"

#include <algorithm>

namespace winnow {

WINNOW_DEFINE_KERNELS(HierarchicalGridKernels, hierarchical_grid_kernels)

namespace {

constexpr std::size_t kBlock = BoundsPool::kBlock;

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

}  // namespace

HierarchicalGrid::HierarchicalGrid(const PartitionOptions& options)
    : RowPartition(options, options.volume),
      line_(options.memory),
      number_(options.memory),
      rank_(options.memory),
      start_(options.memory),
      key_(options.memory),
      list_(options.memory) {}

void HierarchicalGrid::finish_build() {
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

void HierarchicalGrid::find_misfits(Column<std::uint32_t>& rows, std::size_t limit) noexcept {
  const LevelsView grid = view();
  const auto find = [&](std::size_t task, std::uint32_t* out) {
    std::uint32_t found = 0;
    for (std::size_t l = 0; l < level_count_; ++l) {
      const std::uint32_t begin = std::max(first_line(task), level_[l].first_line);
      const std::uint32_t end = std::min(first_line(task + 1), level_[l].end_line);
      if (begin >= end) continue;
      found += hierarchical_grid_kernels().find_misfits(grid, level_[l], begin, end, out + found);
    }
    return found;
  };
  append_in_order(
      execution(), std::min(kMostTasks, line_.size()), list_.data(),
      [&](std::size_t task) { return start_[line_[first_line(task)].cell]; }, find, rows, limit);
}

std::uint32_t HierarchicalGrid::first_line(std::size_t task) const noexcept {
  return static_cast<std::uint32_t>(line_.size() * task / std::min(kMostTasks, line_.size()));
}

std::size_t HierarchicalGrid::regular_tasks() const noexcept {
  return std::min(kMostTasks, (regular_rows() + kBlock - 1) / kBlock);
}

bool HierarchicalGrid::run_regular_task(std::size_t task, PairSink& sink) const noexcept {
  const std::size_t blocks = (regular_rows() + kBlock - 1) / kBlock;
  const auto begin = static_cast<std::uint32_t>(blocks * task / regular_tasks());
  const auto end = static_cast<std::uint32_t>(blocks * (task + 1) / regular_tasks());
  return hierarchical_grid_kernels().self_pairs(view(), begin, end, sink);
}

bool HierarchicalGrid::query_regular(const QueryBatch& batch, PairSink& sink) const noexcept {
  return hierarchical_grid_kernels().query(view(), batch, sink);
}

LevelsView HierarchicalGrid::view() const noexcept {
  return {row_view(),    level_.data(),  static_cast<std::uint32_t>(level_count_),
          line_.data(),  number_.data(), rank_.data(),
          start_.data(), key_.data()};
}

void HierarchicalGrid::draw_regular(DebugDraw& draw, const DebugDrawOptions&) const {
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

void HierarchicalGrid::release_structure() noexcept {
  line_.release();
  number_.release();
  rank_.release();
  start_.release();
  key_.release();
  list_.release();
}

void HierarchicalGrid::add_structure_bytes(Footprint& footprint) const noexcept {
  footprint.structure += line_.bytes();
  footprint.structure += number_.bytes();
  footprint.structure += rank_.bytes();
  footprint.structure += start_.bytes();
  footprint.structure += key_.bytes();
  footprint.scratch += list_.bytes();
}

std::size_t HierarchicalGrid::cell_count() const noexcept {
  if (regular_rows() == 0) return RowPartition::cell_count();
  return start_.empty() ? 0 : start_.size() - 1;
}

}  // namespace winnow
