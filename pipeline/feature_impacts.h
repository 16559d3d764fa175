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

/// Kinds of feature pairs of meshes, each given by four points.
enum class FeaturePair : std::uint8_t {
  vertex_face,  ///< point 0 and the triangle of points 1, 2 and 3
  edge_edge,    ///< the edge from point 0 to 1 and the edge from point 2 to 3
};

/// When features count as touching, and the limit of work.
struct FeatureImpactOptions {
  /// Distance at which features touch: finite, >= 0, in units of the points.
  double min_separation = 0.0;
  /// How early the returned time may be before the first touch, in (0, 1], apart from rounding.
  /// Features that stay apart, but come closer than the distance that they move in a time of
  /// `tolerance`, may be reported as touching.
  double tolerance = 0x1p-40;
  /// Largest number of time intervals to examine, at least 1. If they do not settle the result, an
  /// impact at the first unsettled time is returned: early, never late.
  std::uint32_t max_intervals = 2048;
};

/// Result for one pair of features.
struct FeatureImpact {
  bool hit = false;  ///< false: they do not touch in [0, 1]
  /// Time of the first touch, in [0, 1], never late; infinite if there is none.
  double time = std::numeric_limits<double>::infinity();
};

/// Finds the time at which two features first touch, while each of their points moves linearly from
/// `start` at time 0 to `end` at time 1. Degenerate features count as the segment or point that
/// they are. The result is certified: no touch is missed and no time is late, rounding included;
/// coordinates are taken as exact. A hit without a touch is possible only if the gap is at most
/// about 1e-14 of the size and motion of the features, or at most the distance that they move in a
/// time of `tolerance`, or if `max_intervals` is reached.
///
/// The differences of the points of the two features span a polygon whose corners move linearly;
/// the features touch when this polygon contains the origin. Two tests rule out time intervals. The
/// first test: the volume spanned by the points, a cubic polynomial in time, has no zero in the
/// interval (shown by the hull of its Bernstein coefficients, as in Bezier clipping: Sederberg and
/// Nishita, "Curve intersection using Bezier clipping", 1990). The second test: a fixed plane
/// separates the polygon from the origin at both ends of the interval. Because the corners move
/// linearly, the plane then separates them during the whole interval. Compare the three-dimensional
/// inclusion of Wang et al., "A large-scale benchmark and an inclusion-based algorithm for
/// continuous collision detection", 2021.
///
/// `invalid_bounds` if a coordinate is not finite or a difference of two overflows;
/// `invalid_argument` for options out of range.
[[nodiscard]] WINNOW_API Answer<FeatureImpact> feature_impact(
    FeaturePair kind, const std::array<Vec3d, 4>& start, const std::array<Vec3d, 4>& end,
    const FeatureImpactOptions& options = {}) noexcept;

/// Many pairs of features, in columns in the caller's memory: coordinate `axis` of point k of pair
/// i at the start is start[k][axis][i]. Nothing is copied, so the object must not outlive the
/// memory.
struct FeatureColumns {
  std::array<std::array<const double*, 3>, 4> start{};  ///< at time 0
  std::array<std::array<const double*, 3>, 4> end{};    ///< at time 1
  std::size_t count = 0;                                ///< number of pairs
};

/// As `feature_impact`, for many pairs: times[i] is the time of pair i, infinite if there is no
/// impact, NaN if its coordinates are invalid. Results equal single calls bit for bit, on any
/// instruction set; a cheap test that rules out most pairs runs on several at a time.
/// `size_mismatch` if `times` and the pairs differ in number; `invalid_argument` for invalid
/// options or missing columns.
[[nodiscard]] WINNOW_API Status feature_impacts(FeaturePair kind, const FeatureColumns& pairs,
                                                std::span<double> times,
                                                const FeatureImpactOptions& options = {}) noexcept;

}  // namespace winnow
