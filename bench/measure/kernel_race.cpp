// Times the kernels of partitions (flat, tree, grid, sweep) on every instruction set, on unit cubes
// in the columns that the kernels read. bench/rows/kernel_rows.cpp calls `race_kernels`.

#include "bench/measure/kernel_race.h"

#include "bench/common/interleaved_runs.h"
#include "bench/common/sample.h"
#include "bench/measure/isa_guard.h"
#include "bench/scenes/cameras.h"
#include "bench/scenes/scene.h"
#include "core/memory/bounds_pool.h"
#include "partitions/rows/row_view.h"
#include "partitions/structures/brute_force/flat_rows.kernel.h"
#include "partitions/structures/cells/cells.kernel.h"
#include "partitions/structures/grid/flat_grid.kernel.h"
#include "partitions/structures/sweep/sweep_and_prune.kernel.h"
#include "partitions/tree/block_tree.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <numeric>
#include <stdexcept>

namespace winnow::bench {
namespace {

constexpr std::size_t kKernelObjects = 4096;
/// Capacity of the result buffer, in pairs.
constexpr std::size_t kRoom = std::size_t{1} << 18U;
constexpr double kTurnMs = 1.0;

using CellCounts = std::array<std::uint32_t, 3>;

void store(const Aabb& box, std::size_t row, BoundsPool& pool) {
  if (pool.volume() == Volume::sphere) {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      pool.column(a)[row] = box.min[axis];
      pool.column(3 + a)[row] = box.max[axis];
      pool.column(kCenterColumn + a)[row] = 0.5F * (box.min[axis] + box.max[axis]);
    }
    pool.column(kRadiusColumn)[row] = 0.5F * (box.max.x() - box.min.x());
    return;
  }
  // The first three slabs of a k-DOP are the box; the diagonal ones follow from its corners.
  const std::size_t slabs = slab_count(pool.volume());
  for (std::size_t s = 0; s < slabs; ++s) {
    const auto a = static_cast<Eigen::Index>(s % 3);
    const auto b = static_cast<Eigen::Index>((s + 1) % 3);
    pool.column(low_column(slabs, s))[row] = s < 3 ? box.min[a] : box.min[a] + box.min[b];
    pool.column(high_column(slabs, s))[row] = s < 3 ? box.max[a] : box.max[a] + box.max[b];
  }
}

/// Input of the kernels: the cubes of `uniform` in the columns of a pool, padded and ordered by
/// cells. With one cell on axis 0 the cells are strips that are swept along that axis.
class KernelRows {
 public:
  KernelRows(std::size_t objects, const CellCounts& cells, Volume volume = Volume::aabb)
      : pool(std::pmr::get_default_resource(), volume), tree(std::pmr::get_default_resource()) {
    const auto scene = make_scene("uniform", objects, 1);
    const std::span<const Aabb> boxes = scene->boxes();
    lay_cells(boxes, cells);
    if (!pool.reserve(objects)) throw std::bad_alloc();
    pool.append(objects);
    const std::vector<std::uint32_t> order = order_by_cells(boxes);
    for (std::size_t row = 0; row < objects; ++row) {
      store(boxes[order[row]], row, pool);
      pool.ids()[row] = order[row];
      key_.push_back(boxes[order[row]].min[0]);
    }
    pool.pad();
    if (!tree.cover(0, pool.blocks())) throw std::bad_alloc();
    tree.refit_all(rows(), Execution::serial());
  }

  [[nodiscard]] RowView rows() const {
    RowView view;
    for (std::size_t c = 0; c < pool.columns(); ++c) view.column[c] = pool.column(c);
    view.further_slabs = static_cast<std::uint32_t>(slab_count(pool.volume())) - 3;
    view.spheres = pool.volume() == Volume::sphere;
    view.id = pool.ids();
    return view;
  }
  /// Returns all rows as a batch of queries.
  [[nodiscard]] QueryBatch all_rows() const {
    QueryBatch batch;
    for (std::size_t c = 0; c < pool.columns(); ++c) batch.column[c] = pool.column(c);
    batch.is_box = pool.volume() == Volume::aabb;
    batch.id = pool.ids();
    batch.end = static_cast<std::uint32_t>(pool.rows());
    batch.mode = HitMode::query_first;
    return batch;
  }
  [[nodiscard]] FlatView flat() const { return {rows(), static_cast<std::uint32_t>(pool.rows())}; }
  [[nodiscard]] GridView grid() const {
    return {rows(), start_.data(), {axis_[0], axis_[1], axis_[2]}};
  }
  [[nodiscard]] StripView strips() const {
    return {rows(), key_.data(), start_.data(), {axis_[0], axis_[1], axis_[2]}};
  }
  [[nodiscard]] TreeView nodes() const { return tree.view(rows()); }
  /// Returns the number of rows of cells along axis 0, or of strips.
  [[nodiscard]] std::uint32_t lines() const { return axis_[1].count * axis_[2].count; }

  BoundsPool pool;
  BlockTree tree;

 private:
  void lay_cells(std::span<const Aabb> boxes, const CellCounts& cells) {
    constexpr float inf = std::numeric_limits<float>::infinity();
    const Aabb world = world_of(boxes);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto index = static_cast<Eigen::Index>(a);
      const std::uint32_t count = cells[a];
      const float origin = world.min[index];
      const float width = (world.max[index] - origin) / static_cast<float>(count);
      for (std::uint32_t c = 0; c < count; ++c) {
        from_[a].push_back(c == 0 ? -inf : origin + static_cast<float>(c) * width);
        to_[a].push_back(c + 1 == count ? inf : origin + static_cast<float>(c + 1) * width);
      }
      // Cubes of edge 1, except for rounding of their upper ends.
      axis_[a] = {.from = from_[a].data(),
                  .to = to_[a].data(),
                  .count = count,
                  .axis = static_cast<std::uint32_t>(a),
                  .origin = origin,
                  .inverse = 1.0F / width,
                  .reach = 1.001F,
                  .limit = 1.001F};
    }
  }

  std::vector<std::uint32_t> order_by_cells(std::span<const Aabb> boxes) {
    const auto cell_of = [&](std::uint32_t i) {
      CellCounts at{};
      for (std::size_t a = 0; a < 3; ++a) {
        at[a] = last_cell(axis_[a], boxes[i].min[static_cast<Eigen::Index>(a)]);
      }
      return (at[2] * axis_[1].count + at[1]) * axis_[0].count + at[0];
    };
    std::vector<std::uint32_t> order(boxes.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const std::uint32_t cell_a = cell_of(a);
      const std::uint32_t cell_b = cell_of(b);
      return cell_a != cell_b ? cell_a < cell_b : boxes[a].min[0] < boxes[b].min[0];
    });
    start_.assign(std::size_t{axis_[0].count} * lines() + 1, 0);
    for (const std::uint32_t i : order) ++start_[cell_of(i) + 1];
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    return order;
  }

  std::array<CellAxis, 3> axis_;
  std::array<std::vector<float>, 3> from_;
  std::array<std::vector<float>, 3> to_;
  std::vector<std::uint32_t> start_;  // first row of each cell, then the end
  std::vector<float> key_;            // lower end of each row on axis 0
};

struct Kernel {
  std::string name;
  /// Writes pairs; returns false if the buffer is full.
  std::function<bool(PairSink&)> call;
};

void add_flat(std::vector<Kernel>& all, const std::string& name, std::size_t objects, Volume volume,
              FlatKernel FlatKernels::*kernel) {
  const auto rows = std::make_shared<const KernelRows>(objects, CellCounts{1, 1, 1}, volume);
  const std::string suffix = name + " " + std::to_string(objects);
  all.push_back({"flat self pairs, " + suffix, [=](PairSink& sink) {
                   const auto blocks = static_cast<std::uint32_t>(rows->pool.blocks());
                   return (flat_kernels().*kernel).self_pairs(rows->flat(), 0, blocks, sink);
                 }});
  all.push_back({"flat query, " + suffix, [=](PairSink& sink) {
                   return (flat_kernels().*kernel).query(rows->flat(), rows->all_rows(), sink);
                 }});
}

void add_tree(std::vector<Kernel>& all) {
  // Ordered by cells of about 16 objects, so that blocks are compact.
  const auto rows = std::make_shared<const KernelRows>(kKernelObjects, CellCounts{6, 6, 6});
  all.push_back({"tree refit", [=](PairSink&) {
                   const TreeView tree = rows->nodes();
                   block_tree_kernels().refit_leaves(tree, 0, tree.count[0]);
                   for (std::uint32_t level = 1; level < tree.levels; ++level) {
                     block_tree_kernels().refit_nodes(tree, level, 0, tree.count[level]);
                   }
                   return true;
                 }});
  all.push_back({"tree self pairs", [=](PairSink& sink) {
                   const auto groups = static_cast<std::uint32_t>(rows->tree.groups());
                   return block_tree_kernels().self_pairs(rows->nodes(), 0, groups, sink);
                 }});
  all.push_back({"tree query", [=](PairSink& sink) {
                   return block_tree_kernels().query(rows->nodes(), rows->all_rows(), sink);
                 }});
}

void add_cells(std::vector<Kernel>& all) {
  // The world has edge 20, so cells have edge 1.4.
  const auto cells = std::make_shared<const KernelRows>(kKernelObjects, CellCounts{15, 15, 15});
  all.push_back({"grid self pairs", [=](PairSink& sink) {
                   return flat_grid_kernels().self_pairs(cells->grid(), 0, cells->lines(), sink);
                 }});
  all.push_back({"grid query", [=](PairSink& sink) {
                   return flat_grid_kernels().query(cells->grid(), cells->all_rows(), sink);
                 }});
  // One entry for each row, and one full vector store past the end.
  const auto misfits = std::make_shared<std::vector<std::uint32_t>>(kKernelObjects + 16);
  all.push_back({"grid find misfits", [=](PairSink&) {
                   const GridView grid = cells->grid();
                   (void)flat_grid_kernels().find_misfits(grid, 0, cells->lines(), misfits->data());
                   return true;
                 }});
  const auto strips = std::make_shared<const KernelRows>(kKernelObjects, CellCounts{1, 5, 5});
  all.push_back({"sweep self pairs", [=](PairSink& sink) {
                   return sweep_kernels().self_pairs(strips->strips(), 0, strips->lines(), sink);
                 }});
  all.push_back({"sweep query", [=](PairSink& sink) {
                   return sweep_kernels().query(strips->strips(), strips->all_rows(), sink);
                 }});
}

std::vector<Kernel> all_kernels() {
  std::vector<Kernel> all;
  add_flat(all, "untested", 256, Volume::aabb, &FlatKernels::untested);
  add_flat(all, "aabb", 256, Volume::aabb, &FlatKernels::aabb);
  add_flat(all, "aabb", 2048, Volume::aabb, &FlatKernels::aabb);
  add_flat(all, "sphere", 256, Volume::sphere, &FlatKernels::sphere);
  add_flat(all, "sphere", 2048, Volume::sphere, &FlatKernels::sphere);
  add_flat(all, "14-DOP", 2048, Volume::kdop14, &FlatKernels::kdop14);
  add_flat(all, "18-DOP", 2048, Volume::kdop18, &FlatKernels::kdop18);
  add_flat(all, "26-DOP", 2048, Volume::kdop26, &FlatKernels::kdop26);
  add_tree(all);
  add_cells(all);
  return all;
}

/// Calls a kernel once; all calls write to the same buffer.
void call(const Kernel& kernel, std::vector<std::uint32_t>& room, KernelTiming& timing) {
  PairSink sink;
  sink.cursor = room.data();
  sink.limit = room.data() + 2 * kRoom;
  sink.grow = [](PairSink&) { return false; };
  if (!kernel.call(sink)) throw std::runtime_error(kernel.name + ": too many pairs");
  timing.tests = 16 * sink.tests;
  timing.pairs = static_cast<std::uint64_t>(sink.cursor - room.data()) / 2;
}

}  // namespace

std::vector<KernelTiming> race_kernels(std::size_t rounds, const std::string& text) {
  const IsaGuard guard;
  std::vector<Kernel> kernels = all_kernels();
  std::erase_if(kernels,
                [&](const Kernel& one) { return one.name.find(text) == std::string::npos; });
  std::vector<KernelTiming> timings;
  for (const Kernel& kernel : kernels) {
    for (const Isa isa : available_isas()) timings.push_back({.kernel = kernel.name, .isa = isa});
  }
  std::vector<std::uint32_t> room(2 * (kRoom + kSinkSlack));
  auto ns = run_interleaved(timings.size(), rounds, 0, [&](std::size_t, std::size_t i) {
    const Kernel& kernel = kernels[i / available_isas().size()];
    IsaGuard::choose(timings[i].isa);
    const ThreadStopwatch once;
    call(kernel, room, timings[i]);  // warms the caches and determines the number of calls per turn
    const auto calls = static_cast<std::size_t>(kTurnMs / std::max(once.ms(), 1e-4)) + 1;
    const ThreadStopwatch clock;
    for (std::size_t c = 0; c < calls; ++c) call(kernel, room, timings[i]);
    return clock.ms() * 1e6 / static_cast<double>(calls);
  });
  for (std::size_t i = 0; i < timings.size(); ++i) timings[i].ns = std::move(ns[i]);
  return timings;
}

}  // namespace winnow::bench
