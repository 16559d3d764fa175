#include <winnow/partitions/partition.h>

#include "partitions/choice/auto_partition.h"
#include "partitions/structures/brute_force/bounds_n_squared.h"
#include "partitions/structures/brute_force/n_squared.h"
#include "partitions/structures/bvh/linear_bvh.h"
#include "partitions/structures/bvh/static_bvh.h"
#include "partitions/structures/grid/flat_grid.h"
#include "partitions/structures/levels/hierarchical_grid.h"
#include "partitions/structures/octree/loose_octree.h"
#include "partitions/structures/octree/loose_quadtree.h"
#include "partitions/structures/sweep/sweep_and_prune.h"

#include <array>

namespace winnow {
namespace {

using Maker = std::unique_ptr<Partition> (*)(const PartitionOptions&);

template <typename T>
std::unique_ptr<Partition> make(const PartitionOptions& options) {
  return std::make_unique<T>(options);
}

constexpr std::array<std::string_view, 10> kNames{
    "NSquared",    "BoundsNSquared", "SweepAndPrune", "FlatGrid",  "HierarchicalGrid",
    "LooseOctree", "LooseQuadtree",  "LinearBvh",     "StaticBvh", "AutoPartition"};
constexpr std::array<Maker, kNames.size()> kMakers{
    make<NSquared>,         make<BoundsNSquared>, make<SweepAndPrune>, make<FlatGrid>,
    make<HierarchicalGrid>, make<LooseOctree>,    make<LooseQuadtree>, make<LinearBvh>,
    make<StaticBvh>,        make<AutoPartition>};

}  // namespace

std::span<const std::string_view> partition_names() noexcept {
  return kNames;
}

std::unique_ptr<Partition> make_partition(std::string_view name, const PartitionOptions& options) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == name) return kMakers[i](options);
  }
  return nullptr;
}

}  // namespace winnow
