#include "bench/micro/run_kernel.h"
#include "bench/micro/suite.h"
#include "partitions/structures/brute_force/flat_rows.kernel.h"

#include <memory>

namespace winnow::bench {
namespace {

struct FlatFixture {
  FlatFixture(std::size_t objects, Volume volume) : scene(random_cubes(objects), {}, volume) {}

  [[nodiscard]] FlatView view() const { return {scene.rows(), scene.row_count()}; }

  KernelScene scene;
  SinkBuffer buffer;
};

void add(const std::string& name, std::size_t objects, Volume volume,
         FlatKernel FlatKernels::*kernel) {
  const auto fixture = std::make_shared<FlatFixture>(objects, volume);
  const std::string suffix = name + " " + std::to_string(objects);
  add_per_isa("kernel: flat self pairs, " + suffix, [=](benchmark::State& state) {
    const FlatView view = fixture->view();
    const auto blocks = static_cast<std::uint32_t>(fixture->scene.pool.blocks());
    run_pair_kernel(state, fixture->buffer, [&](PairSink& sink) {
      return (flat_kernels().*kernel).self_pairs(view, 0, blocks, sink);
    });
  });
  add_per_isa("kernel: flat query, " + suffix, [=](benchmark::State& state) {
    const FlatView view = fixture->view();
    const QueryBatch batch = fixture->scene.all_rows();
    run_pair_kernel(state, fixture->buffer, [&](PairSink& sink) {
      return (flat_kernels().*kernel).query(view, batch, sink);
    });
  });
}

}  // namespace

void add_flat_kernels() {
  add("untested", 256, Volume::aabb, &FlatKernels::untested);
  add("aabb", 256, Volume::aabb, &FlatKernels::aabb);
  add("aabb", 2048, Volume::aabb, &FlatKernels::aabb);
  add("sphere", 256, Volume::sphere, &FlatKernels::sphere);
  add("sphere", 2048, Volume::sphere, &FlatKernels::sphere);
  add("14-DOP", 2048, Volume::kdop14, &FlatKernels::kdop14);
  add("18-DOP", 2048, Volume::kdop18, &FlatKernels::kdop18);
  add("26-DOP", 2048, Volume::kdop26, &FlatKernels::kdop26);
}

}  // namespace winnow::bench
