#include <winnow/partitions/partition.h>

#include <winnow/partitions/auto_partition.h>
#include <winnow/partitions/bounds_n_squared.h>
#include <winnow/partitions/flat_grid.h>
#include <winnow/partitions/hierarchical_grid.h>
#include <winnow/partitions/linear_bvh.h>
#include <winnow/partitions/loose_octree.h>
#include <winnow/partitions/loose_quadtree.h>
#include <winnow/partitions/n_squared.h>
#include <winnow/partitions/static_bvh.h>
#include <winnow/partitions/sweep_and_prune.h>

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
