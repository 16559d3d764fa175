#pragma once

#include "partitions/choice/scene_features.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace winnow {

/// The partitions that AutoPartition chooses from.
enum class PartitionKind : std::uint8_t {
  bounds_n_squared,
  sweep_and_prune,
  flat_grid,
  hierarchical_grid,
  linear_bvh,
  static_bvh
};

inline constexpr std::size_t kPartitionKinds = 6;

/// What a frame did.
struct FrameWork {
  std::size_t changed = 0;       ///< objects moved, inserted or removed, at most all
  std::size_t pair_queries = 0;  ///< for all pairs
  std::size_t full_queries = 0;  ///< of them, how many asked for every pair anew
  std::size_t casts = 0;         ///< rays and swept volumes
  std::size_t regions = 0;       ///< boxes, spheres, frusta
  std::size_t nearest = 0;
};

/// What one frame is expected to cost each partition, and what it costs to begin with that
/// partition, in nanoseconds of one thread.
///
/// A frame is a sum of a few products, each of a feature and of a constant by partition:
///
/// - itself (`frame`), and each object that moved, which is written and its place in the structure
///   kept up (`keep`);
/// - for all pairs after much has moved: every object is asked (`object`, and `level` for each
///   doubling of their number: depth and caches) and is tested against more of the others the more
///   these crowd together (`crowd`) and the more pairs there are, which are written, too (`pair`);
///   brute force tests all (`square`);
/// - for all pairs after little has moved: each object that moved is asked (`moved`, `level`,
///   `square`), its share of the pairs is redone (`pair`), and flags of the rest are read (`rest`);
/// - for every other query (one for the nearest counts four times): `ask`, `ask_level` for each
///   doubling of the number of objects, and where there is no tree, `scan` an object. A tree over
///   the rows of cells and strips is refitted first (`rows`, an object that moved).
///
/// To begin with a partition takes a build: `build` an object, `build_level` for each doubling.
///
/// The constants were fitted, without negative ones, to the relative error of times measured on one
/// thread with AVX-512 on the built-in scenes and on recordings of simulations: of 20 to 100,000
/// objects all moving, midway between the median and the mean frame, so that builds weigh in
/// without ruling; and of 1 and 5 % of the objects moving. Those of other queries were fitted to
/// single rays, boxes and nearest objects there. They are right to a sixth or so where all moves
/// and to a third elsewhere. What they say is that where most objects move, HierarchicalGrid is the
/// best choice from one or two thousand objects on and LinearBvh below; LinearBvh where few move,
/// and StaticBvh where much is asked, too; brute force below some 50 objects. LooseOctree and
/// LooseQuadtree are not among the kinds: no scene, flat worlds included, is cheaper by them than
/// by the best of the others. A spread of sizes tells nothing that the number of pairs does not.
class PartitionCosts {
 public:
  using List = std::array<double, kPartitionKinds>;

  /// `pairs` is the number of pairs of the scene.
  PartitionCosts(const SceneFeatures& scene, const FrameWork& frame, double pairs) noexcept;

  /// Of one frame.
  [[nodiscard]] double of(PartitionKind kind) const noexcept {
    return total_[static_cast<std::size_t>(kind)];
  }
  /// The part of it that goes into queries other than for all pairs.
  [[nodiscard]] double queries_of(PartitionKind kind) const noexcept {
    return queries_[static_cast<std::size_t>(kind)];
  }
  /// Of a build.
  [[nodiscard]] double build_of(PartitionKind kind) const noexcept {
    return build_[static_cast<std::size_t>(kind)];
  }
  /// The cheapest for so many frames like this one, the first build included.
  [[nodiscard]] PartitionKind cheapest(double frames) const noexcept;

 private:
  List total_{};
  List queries_{};
  List build_{};
};

[[nodiscard]] std::string_view partition_name(PartitionKind kind) noexcept;

}  // namespace winnow
