#include "bench/micro/run_kernel.h"
#include "bench/micro/suite.h"
#include "partitions/tree/block_tree.h"

#include <memory>
#include <new>

namespace winnow::bench {
namespace {

constexpr std::size_t kObjects = 4096;

struct TreeFixture {
  // Rows in the order of cells of some 16 objects, so that blocks are compact.
  TreeFixture()
      : scene(random_cubes(kObjects), {{6, 6, 6}}), tree(std::pmr::get_default_resource()) {
    if (!tree.cover(0, scene.pool.blocks())) throw std::bad_alloc();
    tree.refit_all(scene.rows(), Execution::serial());
  }

  [[nodiscard]] TreeView view() const { return tree.view(scene.rows()); }

  KernelScene scene;
  BlockTree tree;
  SinkBuffer buffer;
};

}  // namespace

void add_tree_kernels() {
  const auto fixture = std::make_shared<TreeFixture>();
  add_per_isa("kernel: tree refit", [=](benchmark::State& state) {
    const TreeView tree = fixture->view();
    for (auto _ : state) {
      block_tree_kernels().refit_leaves(tree, 0, tree.count[0]);
      for (std::uint32_t level = 1; level < tree.levels; ++level) {
        block_tree_kernels().refit_nodes(tree, level, 0, tree.count[level]);
      }
      benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kObjects));
  });
  add_per_isa("kernel: tree self pairs", [=](benchmark::State& state) {
    const TreeView tree = fixture->view();
    const auto groups = static_cast<std::uint32_t>(fixture->tree.groups());
    run_pair_kernel(state, fixture->buffer, [&](PairSink& sink) {
      return block_tree_kernels().self_pairs(tree, 0, groups, sink);
    });
  });
  add_per_isa("kernel: tree query", [=](benchmark::State& state) {
    const TreeView tree = fixture->view();
    const QueryBatch batch = fixture->scene.all_rows();
    run_pair_kernel(state, fixture->buffer,
                    [&](PairSink& sink) { return block_tree_kernels().query(tree, batch, sink); });
  });
}

}  // namespace winnow::bench
