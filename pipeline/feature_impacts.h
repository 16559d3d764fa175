#pragma once

#include <winnow/core/export.h>
#include <winnow/core/status.h>
#include <winnow/core/vec3.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace winnow {

/// Which features of meshes meet in a test of four points.
enum class FeaturePair : std::uint8_t {
  vertex_face,  ///< point 0 against the triangle of points 1, 2 and 3
  edge_edge,    ///< the edge from point 0 to 1 against that from point 2 to 3
};

/// When features count as touching, and how much work goes into it.
struct FeatureImpactOptions {
  /// Features touch at a distance of at most this: finite, >= 0. In units of the points.
  double min_separation = 0.0;
  /// How long before the first touch the time may lie, in (0, 1], where rounding does not ask for
  /// more. Features that stay apart but come closer than what they move in such a time may count as
  /// touching.
  double tolerance = 0x1p-40;
  /// Intervals of time that are looked at, at least 1. If these do not settle the answer, it is an
  /// impact at the first time that is not settled: early, never late.
  std::uint32_t max_intervals = 2048;
};

/// The answer about two features.
struct FeatureImpact {
  bool hit = false;  ///< false: they do not touch in [0, 1]
  /// Of the first touch, in [0, 1], never later; infinite without one.
  double time = std::numeric_limits<double>::infinity();
};

/// When two features first touch while each of their points moves linearly from `start` at time 0
/// to `end` at time 1; degenerate features are what is left of them. Certified: rounding included,
/// no touch is missed and no time is late; the numbers are taken as exact. A hit without a touch
/// takes a gap of about 1e-14 of what the features extend and move, or of `tolerance`.
///
/// The differences of the points of either feature span a polygon, each of whose corners moves
/// linearly: the features touch when it meets the origin. Times are dismissed where the volume that
/// the points span, a cubic polynomial, has no zero (by the hull of its Bernstein coefficients, as
/// in Bezier clipping: Sederberg and Nishita, "Curve intersection using Bezier clipping", 1990),
/// and where a fixed plane keeps the polygon from the origin, which is so for a whole interval if
/// it is at both ends. Compare the inclusion in three dimensions of Wang et al., "A large-scale
/// benchmark and an inclusion-based algorithm for continuous collision detection", 2021.
///
/// `invalid_bounds` if a coordinate is not finite or a difference of two overflows,
/// `invalid_argument` for options outside of their ranges.
[[nodiscard]] WINNOW_API Status feature_impact(FeaturePair kind, const std::array<Vec3d, 4>& start,
                                               const std::array<Vec3d, 4>& end,
                                               FeatureImpact& impact,
                                               const FeatureImpactOptions& options = {}) noexcept;

/// Many pairs of features in columns: coordinate `axis` of point k of pair i at the start is
/// start[k][axis][i]. Nothing is copied, and it must not outlive the memory it looks at.
struct FeatureColumns {
  std::array<std::array<const double*, 3>, 4> start{};  ///< at time 0
  std::array<std::array<const double*, 3>, 4> end{};    ///< at time 1
  std::size_t count = 0;                                ///< pairs
};

/// The same for many pairs, several at a time where a cheap test keeps them apart: times[i] is that
/// of pair i, infinite where it has no impact, NaN where its numbers are bad. The same bytes as one
/// by one, on any instruction set. `size_mismatch` if `times` has another length than there are
/// pairs, `invalid_argument` for bad options or missing columns.
[[nodiscard]] WINNOW_API Status feature_impacts(FeaturePair kind, const FeatureColumns& pairs,
                                                std::span<double> times,
                                                const FeatureImpactOptions& options = {}) noexcept;

}  // namespace winnow
