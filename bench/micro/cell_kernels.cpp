#include "bench/micro/run_kernel.h"
#include "bench/micro/suite.h"
#include "partitions/structures/grid/flat_grid.kernel.h"
#include "partitions/structures/sweep/sweep_and_prune.kernel.h"

#include <memory>
#include <vector>

namespace winnow::bench {
namespace {

constexpr std::size_t kObjects = 4096;

struct CellFixture {
  explicit CellFixture(const KernelScene::Cells& cells) : scene(random_cubes(kObjects), cells) {}

  [[nodiscard]] GridView grid() const {
    return {scene.rows(), scene.start.data(), {scene.axis[0], scene.axis[1], scene.axis[2]}};
  }
  [[nodiscard]] StripView strips() const {
    return {scene.rows(),
            scene.key.data(),
            scene.start.data(),
            {scene.axis[0], scene.axis[1], scene.axis[2]}};
  }
  /// Rows of cells along axis 0, or strips.
  [[nodiscard]] std::uint32_t lines() const { return scene.axis[1].count * scene.axis[2].count; }

  KernelScene scene;
  SinkBuffer buffer;
};

void add_grid() {
  // The world is 20 wide: cells of 1.4.
  const auto fixture = std::make_shared<CellFixture>(KernelScene::Cells{{15, 15, 15}});
  add_per_isa("kernel: grid self pairs", [=](benchmark::State& state) {
    const GridView grid = fixture->grid();
    run_pair_kernel(state, fixture->buffer, [&](PairSink& sink) {
      return flat_grid_kernels().self_pairs(grid, 0, fixture->lines(), sink);
    });
  });
  add_per_isa("kernel: grid query", [=](benchmark::State& state) {
    const GridView grid = fixture->grid();
    const QueryBatch batch = fixture->scene.all_rows();
    run_pair_kernel(state, fixture->buffer,
                    [&](PairSink& sink) { return flat_grid_kernels().query(grid, batch, sink); });
  });
  add_per_isa("kernel: grid find misfits", [=](benchmark::State& state) {
    const GridView grid = fixture->grid();
    // Room for every row, and for one full store behind the last.
    std::vector<std::uint32_t> misfits(kObjects + 16);
    for (auto _ : state) {
      benchmark::DoNotOptimize(
          flat_grid_kernels().find_misfits(grid, 0, fixture->lines(), misfits.data()));
      benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kObjects));
  });
}

void add_strips() {
  const auto fixture = std::make_shared<CellFixture>(KernelScene::Cells{{1, 5, 5}});
  add_per_isa("kernel: sweep self pairs", [=](benchmark::State& state) {
    const StripView strips = fixture->strips();
    run_pair_kernel(state, fixture->buffer, [&](PairSink& sink) {
      return sweep_kernels().self_pairs(strips, 0, fixture->lines(), sink);
    });
  });
  add_per_isa("kernel: sweep query", [=](benchmark::State& state) {
    const StripView strips = fixture->strips();
    const QueryBatch batch = fixture->scene.all_rows();
    run_pair_kernel(state, fixture->buffer,
                    [&](PairSink& sink) { return sweep_kernels().query(strips, batch, sink); });
  });
}

}  // namespace

void add_cell_kernels() {
  add_grid();
  add_strips();
}

}  // namespace winnow::bench
