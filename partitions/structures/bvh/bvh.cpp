// Bounding-volume hierarchies: block trees over all rows, which differ in the order of these.

#include "partitions/structures/costs.h"
#include "partitions/structures/structure.h"
#include "partitions/tree/sah_order.h"

namespace winnow {
namespace {

/// Linearised bounding-volume hierarchy: rows in an order in which every 16, 256, 4096 ... that
/// follow each other are near each other (see kd_order.h), blocks of 16 rows as leaves, and above
/// them implicit nodes of 16 children that one compare tests at once: no pointers, no node that
/// holds anything but boxes. A frame refits the nodes above what moved; the order is made anew when
/// refitting has cost more tests than a build is worth. No parameter, no world bounds; suits every
/// scene, mixed sizes included. Self pairs: O(n log n + pairs) for boxes of bounded overlap. Exact.
///
/// All of this is what the partition does with rows that no structure wants.
class LinearBvh final : public Structure {
 public:
  using Structure::Structure;

  [[nodiscard]] std::uint64_t build_price() const noexcept override { return 4; }
};

/// Bounding-volume hierarchy for objects that hardly ever move: the tree of LinearBvh, its rows in
/// an order that a search by the surface-area heuristic finds (see append_in_sah_order). A build
/// takes many times as long, so it waits for much more wear. From then on rays and boxes meet 1 %
/// fewer nodes in even scenes, 5 to 8 % fewer in clusters and where sizes are spread 100:1, and a
/// third fewer where large and small objects, 1000:1, lie within each other. Where environments are
/// in use the order is that of LinearBvh, which keeps them apart. Exact.
class StaticBvh final : public Structure {
 public:
  explicit StaticBvh(const StructureInput& input) noexcept
      : Structure(input), boxes_(input.memory) {}

  [[nodiscard]] bool reserve(const BuildRoom& room) noexcept override {
    return boxes_.reserve(room.objects, room.pages);
  }
  [[nodiscard]] Ordered order_rest(std::span<std::uint32_t> rest,
                                   Column<std::uint32_t>& order) noexcept override {
    return append_in_sah_order(pool(), rest, boxes_, order, execution()) ? Ordered::done
                                                                         : Ordered::out_of_memory;
  }
  [[nodiscard]] std::uint64_t build_price() const noexcept override { return 240; }
  void release_scratch() noexcept override { boxes_.release(); }
  void add_bytes(Footprint& footprint) const noexcept override {
    footprint.scratch += boxes_.bytes();
  }

 private:
  Column<SahBox> boxes_;  // while building
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
                                      .ask = 50,
                                      .ask_level = 20};
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
                                      .ask = 80,
                                      .ask_level = 13};
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
