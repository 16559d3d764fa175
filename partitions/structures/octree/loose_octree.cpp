#include "partitions/structures/octree/loose_octree.h"

#include <winnow/partitions/debug_colours.h>
#include "core/sort/radix_sort.h"
#include "partitions/structures/cells/cell_drawing.h"
#include "partitions/structures/cells/task_lists.h"

#include <algorithm>
#include <cfloat>

namespace winnow {
namespace {

constexpr std::size_t kRowsPerTask = 16384;
// Longer runs of objects whose places cannot be told apart are sorted better by the tree.
constexpr std::size_t kLongRun = 48;

constexpr std::uint32_t key_in(std::uint64_t item) {
  return static_cast<std::uint32_t>(item >> 32U);
}

}  // namespace

LooseOctree::LooseOctree(const PartitionOptions& options, const LooseOctreeOptions& loose)
    : LooseOctree(options, loose, 3) {}

LooseOctree::LooseOctree(const PartitionOptions& options, const LooseOctreeOptions& loose,
                         std::size_t axes)
    : RowPartition(options, options.volume),
      axes_(axes),
      // Written so that NaN becomes the least.
      loose_(std::min(8.0F, std::max(1.125F, loose.loose))),
      node_(options.memory),
      start_(options.memory),
      bounds_(options.memory),
      left_(options.memory) {}

bool LooseOctree::plan(Column<std::uint32_t>& regular, Column<std::uint32_t>& rest) {
  node_.clear();
  start_.clear();
  bounds_.clear();
  const SceneSample sample(pool());
  if (!cells_.choose(sample, axes_, loose_)) return RowPartition::plan(regular, rest);
  const std::size_t rows = pool().rows();
  // Of a scene in motion builds meet now more rows, now more nodes: this is enough for mostly all.
  const std::size_t most_rows = std::max(rows, size() + size() / 8 + 256);
  const std::size_t nodes = size() / 8 + 64;
  if (!sort_scratch().reserve(2 * most_rows) || !left_.reserve(most_rows)) return false;
  if (!node_.reserve(nodes) || !start_.reserve(nodes) || !bounds_.reserve(nodes)) return false;
  sort_scratch().set_size(2 * rows);
  left_.set_size(rows);
  find_keys();
  std::uint64_t* const items = sort_scratch().data();
  const std::uint64_t* const sorted = radix_sort(items, items + rows, rows, 32, execution());
  std::uint32_t cell = LooseOctreeCells::kNone;
  std::size_t run = 0;
  while (run < rows && key_in(sorted[run]) != LooseOctreeCells::kNone) {
    const std::uint32_t key = key_in(sorted[run]);
    std::size_t end = run + 1;
    while (end < rows && key_in(sorted[end]) == key) ++end;
    const bool apart = end - run <= kLongRun;
    if (apart && cells_.cell_of_key(key) != cell) {
      cell = cells_.cell_of_key(key);
      if (!add_node(static_cast<std::uint32_t>(sorted[run]), key, regular.size())) return false;
    }
    Column<std::uint32_t>& rows_of_run = apart ? regular : rest;
    for (; run < end; ++run) (void)rows_of_run.push_back(static_cast<std::uint32_t>(sorted[run]));
  }
  for (; run < rows; ++run) {
    const auto row = static_cast<std::uint32_t>(sorted[run]);
    if (pool().ids()[row] != kNoObject) (void)rest.push_back(row);
  }
  return start_.push_back(static_cast<std::uint32_t>(regular.size()));
}

bool LooseOctree::add_node(std::size_t row, std::uint32_t key, std::size_t start) {
  const std::uint32_t code = cells_.code_of(pool(), row, key);
  return node_.push_back(code) && start_.push_back(static_cast<std::uint32_t>(start)) &&
         bounds_.push_back(cells_.loose_bounds(code));
}

void LooseOctree::find_keys() noexcept {
  const std::size_t rows = pool().rows();
  std::uint64_t* const items = sort_scratch().data();
  execution().for_each((rows + kRowsPerTask - 1) / kRowsPerTask, [&](std::size_t task) {
    const std::size_t end = std::min(rows, (task + 1) * kRowsPerTask);
    for (std::size_t row = task * kRowsPerTask; row < end; ++row) {
      const bool live = pool().ids()[row] != kNoObject;
      const std::uint32_t key = live ? cells_.key_of(pool(), row) : LooseOctreeCells::kNone;
      items[row] = std::uint64_t{key} << 32U | row;
    }
  });
}

bool LooseOctree::fits(std::size_t row) const noexcept {
  const auto after = std::upper_bound(start_.begin(), start_.end(), row);
  const auto node = static_cast<std::size_t>(after - start_.begin() - 1);
  return cells_.hold(bounds_[node], pool(), row, row + 1);
}

void LooseOctree::find_misfits(Column<std::uint32_t>& rows, std::size_t limit) noexcept {
  const std::size_t tasks = std::min(kMostTasks, node_.size());
  const auto first_node = [&](std::size_t task) { return node_.size() * task / tasks; };
  append_in_order(
      execution(), tasks, left_.data(), [&](std::size_t task) { return start_[first_node(task)]; },
      [&](std::size_t task, std::uint32_t* out) {
        std::size_t found = 0;
        for (std::size_t node = first_node(task); node < first_node(task + 1); ++node) {
          const std::uint32_t end = start_[node + 1];
          if (cells_.hold(bounds_[node], pool(), start_[node], end)) continue;
          for (std::uint32_t row = start_[node]; row < end; ++row) {
            out[found] = row;
            found += cells_.hold(bounds_[node], pool(), row, row + 1) ? 0U : 1U;
          }
        }
        return found;
      },
      rows, limit);
}

std::size_t LooseOctree::regular_tasks() const noexcept {
  return std::min<std::size_t>(kMostTasks, (regular_rows() + 255) / 256);
}

bool LooseOctree::run_regular_task(std::size_t task, PairSink& sink) const noexcept {
  const std::size_t groups = (regular_rows() + 255) / 256;
  const std::size_t tasks = regular_tasks();
  const auto begin = static_cast<std::uint32_t>(groups * task / tasks);
  const auto end = static_cast<std::uint32_t>(groups * (task + 1) / tasks);
  return block_tree_kernels().self_pairs(row_tree(), begin, end, sink);
}

bool LooseOctree::query_regular(const QueryBatch& batch, PairSink& sink) const noexcept {
  return block_tree_kernels().query(row_tree(), batch, sink);
}

void LooseOctree::draw_regular(DebugDraw& draw, const DebugDrawOptions&) const {
  const RowView rows = row_view();
  for (std::size_t node = 0; node < node_.size(); ++node) {
    Aabb contents;
    for (std::uint32_t row = start_[node]; row < start_[node + 1]; ++row) {
      contents.merge(stored_box(rows.column, row));
    }
    if (!contents.is_valid()) continue;  // holes only
    const LooseOctreeCells::Bounds bounds = cells_.cell_bounds(node_[node]);
    Aabb cell = contents;
    for (std::size_t k = 0; k < cells_.axes(); ++k) {
      cell.min[static_cast<Eigen::Index>(cells_.axis(k))] = bounds.low[k];
      cell.max[static_cast<Eigen::Index>(cells_.axis(k))] = bounds.high[k];
    }
    draw.box(cell, kCellColour);
    draw.box(contents, kContentsColour);
  }
}

void LooseOctree::release_structure() noexcept {
  node_.release();
  start_.release();
  bounds_.release();
  left_.release();
}

void LooseOctree::add_structure_bytes(Footprint& footprint) const noexcept {
  footprint.structure += node_.bytes();
  footprint.structure += start_.bytes();
  footprint.structure += bounds_.bytes();
  footprint.scratch += left_.bytes();
}

std::size_t LooseOctree::cell_count() const noexcept {
  return regular_rows() == 0 ? RowPartition::cell_count() : node_.size();
}

}  // namespace winnow
