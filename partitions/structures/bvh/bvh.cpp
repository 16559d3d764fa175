// Bounding-volume hierarchies: block trees over all rows. The classes here choose the order of
// the rows and the price of a build; SpatialIndex, which owns the tree (`tree_`), does the rest.
// With other structures the same tree contains the rows that are in no cell. Its parts:
//
//   nodes            tree/block_tree.h: 16 children per node, in arrays by level
//   order of leaves  SpatialIndex::build (index/rebuild.cpp) -> OrderPlan -> KdCuts
//                    (tree/kd_order.h), or append_in_sah_order (tree/sah_order.h)
//   when to build    RebuildPlanner (index/rebuild_planner.h)
//   refit            SpatialIndex::refit (index/spatial_index.cpp) -> BlockTree::refit
//   self pairs       self_pairs in tree/block_tree.kernel.cpp
//   pairs of moved   query in tree/block_tree.kernel.cpp
//   rays, regions    kernels in queries/, over the tree of SpatialIndex::view

#include "partitions/structures/costs.h"
#include "partitions/structures/structure.h"
#include "partitions/tree/sah_order.h"

namespace winnow {
namespace {

/// Linearised bounding-volume hierarchy: rows in a spatial order in which every aligned group of
/// 16, 256, 4096 ... rows is compact (tree/kd_order.h). Blocks of 16 rows are the leaves; above
/// them are implicit nodes with 16 children whose boxes are tested by one SIMD compare. There are
/// no pointers, and nodes store only boxes (and filters, if they are in use). Each frame refits the
/// nodes above moved rows; the order is rebuilt when wear (see RebuildPlanner) exceeds the price of
/// a build. It needs no parameter and no world bounds and suits every scene, including mixed sizes.
/// Self pairs: O(n log n + pairs) for boxes of bounded overlap. Exact.
class LinearBvh final : public Structure {
 public:
  using Structure::Structure;

  [[nodiscard]] std::uint64_t build_price() const noexcept override { return 4; }
};

/// Bounding-volume hierarchy for objects that rarely move: the tree of LinearBvh with rows in the
/// order of a surface-area heuristic (append_in_sah_order). A build takes many times as long, so it
/// is due only after much more wear. Rays and boxes then visit 1 % fewer nodes in even scenes, 5 to
/// 8 % fewer in clusters and in scenes with sizes spread 100:1, and a third fewer in scenes in
/// which objects of sizes 1000:1 overlap. If environments are in use the order is that of
/// LinearBvh, which groups rows by environment. Exact.
class StaticBvh final : public Structure {
 public:
  explicit StaticBvh(const StructureInput& input) noexcept
      : Structure(input), boxes_(input.memory) {}

  [[nodiscard]] bool reserve(const BuildRoom& room) noexcept override {
    return boxes_.reserve(room.objects, room.pages);
  }
  [[nodiscard]] RestOrder order_rest(std::span<std::uint32_t> rest,
                                     Column<std::uint32_t>& order) noexcept override {
    return append_in_sah_order(pool(), rest, boxes_, order, execution()) ? RestOrder::done
                                                                         : RestOrder::out_of_memory;
  }
  [[nodiscard]] std::uint64_t build_price() const noexcept override { return 240; }
  void release_scratch() noexcept override { boxes_.release(); }
  void add_bytes(Footprint& footprint) const noexcept override {
    footprint.scratch += boxes_.bytes();
  }

 private:
  Column<SahBox> boxes_;  // scratch of builds
};

constexpr StructureCosts kLinearCosts{.frame = 100,
                                      .keep = 6,
                                      .object = 8,
                                      .level = 0.05,
                                      .crowd = 0.6,
                                      .pair = 3.2,
                                      .moved = 200,
                                      .rest = 0.5,
                                      .build_level = 1.95,
                                      .query = 50,
                                      .query_level = 20};
constexpr StructureCosts kStaticCosts{.frame = 110,
                                      .keep = 6,
                                      .object = 8,
                                      .level = 0.2,
                                      .crowd = 0.6,
                                      .pair = 3.2,
                                      .moved = 240,
                                      .rest = 0.5,
                                      .build = 54,
                                      .build_level = 9,
                                      .query = 80,
                                      .query_level = 13};
constexpr StructureInfo kLinear = structure_info<LinearBvh>("LinearBvh", &kLinearCosts);
constexpr StructureInfo kStatic = structure_info<StaticBvh>("StaticBvh", &kStaticCosts);

}  // namespace

StructureKind linear_bvh() noexcept {
  return StructureKind(kLinear);
}

StructureKind static_bvh() noexcept {
  return StructureKind(kStatic);
}

}  // namespace winnow
