// Benchmarks of the kernels of partitions (flat, tree, grid, sweep) on every instruction set, on
// unit cubes in the columns that the kernels read, and one pass over these columns for comparison.
// All sets must find the same pairs in the same order.

#include "bench/micro/micro.h"
#include "core/memory/volume_columns.h"

#include "bench/measure/column_read.h"
#include "bench/scenes/query_set.h"
#include "bench/scenes/scene.h"
#include "core/memory/bounds_pool.h"
#include "partitions/rows/row_view.h"
#include "partitions/structures/brute_force/flat_rows.kernel.h"
#include "partitions/structures/cells/cells.kernel.h"
#include "partitions/structures/grid/flat_grid.kernel.h"
#include "partitions/structures/sweep/sweep_and_prune.kernel.h"
#include "partitions/tree/block_tree.h"

#include <winnow/simd/isa.h>

#include <algorithm>
#include <array>
#include <limits>
#include <new>
#include <numeric>

namespace winnow::bench::micro {
namespace {

constexpr std::size_t kKernelObjects = 4096;
/// Capacity of the result buffer, in pairs.
constexpr std::size_t kRoom = std::size_t{1} << 18U;

using CellCounts = std::array<std::uint32_t, 3>;

void store(const Aabb& box, std::size_t row, BoundsPool& pool) {
  if (pool.volume() == Volume::sphere) {
    for (std::size_t a = 0; a < 3; ++a) {
      pool.column(a)[row] = box.min[a];
      pool.column(3 + a)[row] = box.max[a];
      pool.column(kCenterColumn + a)[row] = 0.5F * (box.min[a] + box.max[a]);
    }
    pool.column(kRadiusColumn)[row] = 0.5F * (box.max.x() - box.min.x());
    return;
  }
  // The first three slabs of a k-DOP are the box; the diagonal ones follow from its corners.
  const std::size_t slabs = slab_count(pool.volume());
  for (std::size_t s = 0; s < slabs; ++s) {
    const std::size_t a = s % 3;
    const std::size_t b = (s + 1) % 3;
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
      const std::uint32_t count = cells[a];
      const float origin = world.min[a];
      const float width = (world.max[a] - origin) / static_cast<float>(count);
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
      for (std::size_t a = 0; a < 3; ++a) at[a] = last_cell(axis_[a], boxes[i].min[a]);
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

/// Writes pairs; returns false if the buffer is full.
using Kernel = std::function<bool(const KernelRows&, PairSink&)>;
/// Options of the rows on which a kernel runs.
struct RowsOptions {
  std::size_t objects = kKernelObjects;
  CellCounts cells{1, 1, 1};
  Volume volume = Volume::aabb;
};

/// Calls a kernel once and returns the numbers that it wrote: two for each pair.
std::span<const std::uint32_t> call(const Kernel& kernel, const KernelRows& rows, PairSink& sink) {
  static std::vector<std::uint32_t> room(2 * (kRoom + kSinkSlack));
  sink = {};
  sink.cursor = room.data();
  sink.limit = room.data() + 2 * kRoom;
  sink.grow = [](PairSink&) { return false; };
  check(kernel(rows, sink), "too many pairs");
  return {room.data(), sink.cursor};
}

void add_kernel(const std::string& name, const RowsOptions& options, const Kernel& kernel) {
  for (const Isa isa : available_isas()) {
    add("kernel/" + name + "/isa:" + to_string(isa), [=](benchmark::State& state) {
      const std::string key = std::to_string(options.objects) + " " +
                              std::to_string(options.cells[0]) + " " +
                              std::to_string(static_cast<int>(options.volume));
      const auto& rows =
          prepared<const KernelRows>(key, options.objects, options.cells, options.volume);
      PairSink sink;
      IsaGuard::choose(available_isas().front());
      const auto found = call(kernel, rows, sink);
      const std::vector<std::uint32_t> expected(found.begin(), found.end());
      IsaGuard::choose(isa);
      check(std::ranges::equal(call(kernel, rows, sink), expected), "other pairs were found");
      run(state, 1, [&] { call(kernel, rows, sink); });
      count(state, "tests", 16 * sink.tests);
      count(state, "pairs", expected.size() / 2);
    });
  }
}

void add_flat(const std::string& name, std::size_t objects, Volume volume,
              FlatKernel FlatKernels::*kernel) {
  const std::string suffix = "/" + name + "/objects:" + std::to_string(objects);
  const RowsOptions options{.objects = objects, .volume = volume};
  add_kernel("flat_self_pairs" + suffix, options, [=](const KernelRows& rows, PairSink& sink) {
    const auto blocks = static_cast<std::uint32_t>(rows.pool.blocks());
    return (flat_kernels().*kernel).self_pairs(rows.flat(), 0, blocks, sink);
  });
  add_kernel("flat_query" + suffix, options, [=](const KernelRows& rows, PairSink& sink) {
    return (flat_kernels().*kernel).query(rows.flat(), rows.all_rows(), sink);
  });
}

void add_tree() {
  // Ordered by cells of about 16 objects, so that blocks are compact.
  const RowsOptions options{.cells = {6, 6, 6}};
  add_kernel("tree_refit", options, [](const KernelRows& rows, PairSink&) {
    const TreeView tree = rows.nodes();
    block_tree_kernels().refit_leaves(tree, 0, tree.count[0]);
    for (std::uint32_t level = 1; level < tree.levels; ++level) {
      block_tree_kernels().refit_nodes(tree, level, 0, tree.count[level]);
    }
    return true;
  });
  add_kernel("tree_self_pairs", options, [](const KernelRows& rows, PairSink& sink) {
    const auto groups = static_cast<std::uint32_t>(rows.tree.groups());
    return block_tree_kernels().self_pairs(rows.nodes(), 0, groups, sink);
  });
  add_kernel("tree_query", options, [](const KernelRows& rows, PairSink& sink) {
    return block_tree_kernels().query(rows.nodes(), rows.all_rows(), sink);
  });
}

void add_cells() {
  // The world has edge 20, so cells have edge 1.4.
  const RowsOptions cells{.cells = {15, 15, 15}};
  add_kernel("grid_self_pairs", cells, [](const KernelRows& rows, PairSink& sink) {
    return flat_grid_kernels().self_pairs(rows.grid(), 0, rows.lines(), sink);
  });
  add_kernel("grid_query", cells, [](const KernelRows& rows, PairSink& sink) {
    return flat_grid_kernels().query(rows.grid(), rows.all_rows(), sink);
  });
  add_kernel("grid_find_misfits", cells, [](const KernelRows& rows, PairSink&) {
    // One entry for each row, and one full vector store past the end.
    static std::array<std::uint32_t, kKernelObjects + 16> misfits;
    const GridView grid = rows.grid();
    (void)flat_grid_kernels().find_misfits(grid, 0, rows.lines(), misfits.data());
    return true;
  });
  const RowsOptions strips{.cells = {1, 5, 5}};
  add_kernel("sweep_self_pairs", strips, [](const KernelRows& rows, PairSink& sink) {
    return sweep_kernels().self_pairs(rows.strips(), 0, rows.lines(), sink);
  });
  add_kernel("sweep_query", strips, [](const KernelRows& rows, PairSink& sink) {
    return sweep_kernels().query(rows.strips(), rows.all_rows(), sink);
  });
}

/// Registers one pass over all boxes, to compare partitions with.
void add_read(std::size_t objects) {
  add("memory/read_boxes/objects:" + std::to_string(objects), [=](benchmark::State& state) {
    const KernelRows rows(objects, {1, 1, 1});
    const RowView view = rows.rows();
    run(state, 1, [&] { benchmark::DoNotOptimize(read_columns(view.column, objects)); });
  });
}

}  // namespace

void add_kernels() {
  add_flat("untested", 256, Volume::aabb, &FlatKernels::untested);
  add_flat("aabb", 256, Volume::aabb, &FlatKernels::aabb);
  add_flat("aabb", 2048, Volume::aabb, &FlatKernels::aabb);
  add_flat("sphere", 256, Volume::sphere, &FlatKernels::sphere);
  add_flat("sphere", 2048, Volume::sphere, &FlatKernels::sphere);
  add_flat("14-dop", 2048, Volume::kdop14, &FlatKernels::kdop14);
  add_flat("18-dop", 2048, Volume::kdop18, &FlatKernels::kdop18);
  add_flat("26-dop", 2048, Volume::kdop26, &FlatKernels::kdop26);
  add_tree();
  add_cells();
  for (const std::size_t objects : {10'000U, 100'000U}) add_read(objects);
}

}  // namespace winnow::bench::micro
