#pragma once

#include <winnow/partitions/structures.h>
#include "partitions/structures/costs.h"

#include <array>
#include <cstddef>
#include <span>

namespace winnow {

/// The candidates of the automatic choice: the members of all_structures() that have costs.
inline constexpr std::size_t kMaxCandidates = 16;
[[nodiscard]] std::span<const StructureKind> candidates() noexcept;

/// The work of one frame.
struct FrameWork {
  std::size_t changed = 0;       ///< objects moved, inserted or removed, at most all
  std::size_t pair_queries = 0;  ///< queries for all pairs
  std::size_t full_queries = 0;  ///< pair queries that compute every pair again
  std::size_t casts = 0;         ///< rays and swept volumes
  std::size_t regions = 0;       ///< boxes, spheres, frusta
  std::size_t nearest = 0;
};

/// One constant of a structure, and its factor.
struct CostTerm {
  double StructureCosts::*constant;
  double times;
};
inline constexpr std::size_t kFrameTerms = 9;
inline constexpr std::size_t kBuildTerms = 2;

/// Returns the terms of a frame's cost without casts, regions and nearest queries (see
/// PredictedCosts). `pairs` is the number of pairs of the scene.
[[nodiscard]] std::array<CostTerm, kFrameTerms> frame_terms(const SceneFeatures& scene,
                                                            const FrameWork& frame,
                                                            double pairs) noexcept;
/// Returns the terms of the cost of a build.
[[nodiscard]] std::array<CostTerm, kBuildTerms> build_terms(const SceneFeatures& scene) noexcept;
/// Returns the sum of constant times factor, in nanoseconds.
[[nodiscard]] double sum_of(std::span<const CostTerm> terms, const StructureCosts& costs) noexcept;

/// Predicts, for each candidate, the cost of one frame and the cost of a build, in nanoseconds of
/// one thread.
///
/// The cost of a frame is a sum of products, each of a feature of the scene and a constant of the
/// structure:
///
/// - a constant (`frame`), and for each object that moved the update of its row and of its place in
///   the structure (`keep`);
/// - for a query for all pairs after many objects moved: one query per object (`object`, and for
///   each doubling of the number of objects `level`, because of depth and caches), additional tests
///   if objects crowd together (`crowd`), and the output of each pair (`pair`); brute force tests
///   all pairs (`square`);
/// - for a query for all pairs after few objects moved: one query per object that moved (`moved`,
///   `level`, `square`), the update of its share of the pairs (`pair`), and a read of the flags of
///   the other objects (`rest`);
/// - for every other query (a nearest query counts four times): `query`, `query_level` for each
///   doubling of the number of objects, and without a tree `scan` per object. A tree over the rows
///   of cells and strips is refitted first (`rows`, per object that moved).
///
/// A change of structure costs a build: `build` per object, and `build_level` per object for each
/// doubling of their number. If an update scatters all objects, the rows are written `anew`, which
/// replaces `keep` and the build.
///
/// The constants were fitted to times of one thread with AVX-512 on the built-in scenes, with 40 to
/// 40,000 objects of which all or 5 % move. The time of a scene is midway between its median and
/// its mean frame, so that builds count but do not dominate. The fit first minimizes relative
/// errors without negative constants, then the cost of the choices that follow from them (`winnow
/// fit` prints the constants and their quality). Constants of other queries were fitted to single
/// rays, boxes and nearest queries on the same scenes, and `anew` to teleporting scenes of 1,000 to
/// 100,000 objects. As a result brute force is the choice for few objects, LinearBvh for more, and
/// StaticBvh if there are also many queries. The costs do not use SceneFeatures::size_spread,
/// because it improves no prediction that uses the number of pairs.
class PredictedCosts {
 public:
  using CostList = std::array<double, kMaxCandidates>;

  /// `pairs` is the number of pairs of the scene.
  PredictedCosts(const SceneFeatures& scene, const FrameWork& frame, double pairs) noexcept;

  /// Cost of one frame.
  [[nodiscard]] double of(std::size_t candidate) const noexcept { return total_[candidate]; }
  /// Returns the part of of() that casts, regions and nearest queries cost.
  [[nodiscard]] double queries_of(std::size_t candidate) const noexcept {
    return queries_[candidate];
  }
  /// Cost of a frame in which an update scatters all objects.
  [[nodiscard]] double scattered_of(std::size_t candidate) const noexcept {
    return scattered_[candidate];
  }
  /// Cost of a build.
  [[nodiscard]] double build_of(std::size_t candidate) const noexcept { return build_[candidate]; }
  /// Returns the candidate with the lowest cost for a build and `frames` frames like this one.
  [[nodiscard]] std::size_t cheapest(double frames) const noexcept;

 private:
  CostList total_{};
  CostList queries_{};
  CostList build_{};
  CostList scattered_{};
};

}  // namespace winnow
