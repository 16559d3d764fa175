#pragma once

#include <winnow/partitions/scene_features.h>
#include <winnow/partitions/structures.h>
#include "partitions/structures/costs.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// The structures that are chosen from: those of all_structures() that have costs.
inline constexpr std::size_t kMostCandidates = 16;
[[nodiscard]] std::span<const StructureKind> candidates() noexcept;

/// What a frame did.
struct FrameWork {
  std::size_t changed = 0;       ///< objects moved, inserted or removed, at most all
  std::size_t pair_queries = 0;  ///< for all pairs
  std::size_t full_queries = 0;  ///< of them, how many asked for every pair anew
  std::size_t casts = 0;         ///< rays and swept volumes
  std::size_t regions = 0;       ///< boxes, spheres, frusta
  std::size_t nearest = 0;
};

/// One constant of a structure, and what a prediction multiplies it by.
struct CostTerm {
  double StructureCosts::*constant;
  double times;
};
inline constexpr std::size_t kFrameTerms = 9;
inline constexpr std::size_t kBuildTerms = 2;

/// What a frame costs but for its other queries, as PredictedCosts says. `pairs` is the number of
/// pairs of the scene.
[[nodiscard]] std::array<CostTerm, kFrameTerms> frame_terms(const SceneFeatures& scene,
                                                            const FrameWork& frame,
                                                            double pairs) noexcept;
/// What a build costs.
[[nodiscard]] std::array<CostTerm, kBuildTerms> build_terms(const SceneFeatures& scene) noexcept;
/// Nanoseconds.
[[nodiscard]] double sum_of(std::span<const CostTerm> terms, const StructureCosts& costs) noexcept;

/// What one frame is expected to cost each candidate, and what it costs to begin with that
/// structure, in nanoseconds of one thread.
///
/// A frame is a sum of a few products, each of a feature and of a constant of the structure:
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
///   doubling of the number of objects, and where there is no tree, `scan` per object. A tree over
///   the rows of cells and strips is refitted first (`rows`, per object that moved).
///
/// To begin with a structure takes a build: `build` per object, `build_level` for each doubling.
/// Where an update scatters all objects, the rows are made `anew` rather than kept and then built.
///
/// The constants were fitted to times measured on one thread with AVX-512 on the built-in scenes,
/// of 40 to 40,000 objects, all or 5 % of them moving, midway between the median and the mean
/// frame, so that builds weigh in without ruling: first to the relative errors, without negative
/// ones, then to what choosing by them costs (`winnow fit` of the tool prints them and judges
/// them). Those of other queries were fitted to single rays, boxes and nearest objects there, and
/// those of making all anew to teleporting scenes of 1,000 to 100,000 objects. What they say is
/// that brute force is the best choice for few objects, LinearBvh for more, and StaticBvh where
/// much is asked, too. A spread of sizes tells nothing that the number of pairs does not.
class PredictedCosts {
 public:
  using List = std::array<double, kMostCandidates>;

  /// `pairs` is the number of pairs of the scene.
  PredictedCosts(const SceneFeatures& scene, const FrameWork& frame, double pairs) noexcept;

  /// Of one frame.
  [[nodiscard]] double of(std::size_t candidate) const noexcept { return total_[candidate]; }
  /// The part of it that goes into queries other than for all pairs.
  [[nodiscard]] double queries_of(std::size_t candidate) const noexcept {
    return queries_[candidate];
  }
  /// Of one in which all objects are scattered.
  [[nodiscard]] double scattered_of(std::size_t candidate) const noexcept {
    return scattered_[candidate];
  }
  /// Of a build.
  [[nodiscard]] double build_of(std::size_t candidate) const noexcept { return build_[candidate]; }
  /// The cheapest for so many frames like this one, the first build included.
  [[nodiscard]] std::size_t cheapest(double frames) const noexcept;

 private:
  List total_{};
  List queries_{};
  List build_{};
  List scattered_{};
};

}  // namespace winnow
