#pragma once

#include "pipeline/solver/core.h"
#include "pipeline/solver/gjk.h"
#include "pipeline/solver/problem.h"

#include <cstdint>
#include <limits>

namespace winnow::solver {

/// The best axis tested so far: the unit axis from a to b along which the cores are farthest apart
/// or overlap least. Its separation is a lower bound of their signed distance.
class AxisSearch {
 public:
  AxisSearch(const Core& a, const Core& b) noexcept : a_(a), b_(b) {}

  /// Tests the axis and its opposite; ignores a zero vector.
  void test_axis(const Vec& axis) noexcept;

  [[nodiscard]] const Vec& axis() const noexcept { return axis_; }
  [[nodiscard]] double separation() const noexcept { return separation_; }

 private:
  const Core& a_;
  const Core& b_;
  Vec axis_ = Vec::Zero();
  double separation_ = -std::numeric_limits<double>::infinity();
};

/// Tests axes that are perpendicular to the differences of a simplex' points on a, and of those on
/// b. These axes are right to rounding even if the vector between the closest points is too short
/// to have an accurate direction.
void test_simplex(const GjkResult& found, AxisSearch& search) noexcept;

/// Tests the face normals and caps of both cores.
void test_normals(const Problem& problem, AxisSearch& search) noexcept;

/// Tests the face normals of both cores and the cross products of their edges; for cylinders and
/// cones the caps and the axis. If polytopes overlap, one of these axes is the axis of least depth;
/// if they do not, one of these separates them. (Cores that are all on one line also need the axes
/// of test_across_line in core_distance.cpp.) For two hulls only edge pairs that make a face of the
/// Minkowski difference are tested (Gregorius, "The separating axis test between convex polyhedra",
/// 2013), and only if they may beat the best axis so far. O(edges of a x edges of b); returns false
/// if that exceeds kMaxFeaturePairs and the products of edges were left out.
bool test_features(const Problem& problem, AxisSearch& search) noexcept;

/// The largest number of pairs of edges, or of corners and faces, that are tested for one pair of
/// cores.
inline constexpr std::uint64_t kMaxFeaturePairs = 4'000'000;

/// Returns the sine of the angle between the axes of two points, segments, cylinders or cones: 0 if
/// one is a point, infinity for other cores.
[[nodiscard]] double sine_between_axes(const Problem& problem) noexcept;

/// Tests the axes for points, segments, cylinders and cones whose axes are parallel. Their
/// Minkowski difference is then a body of revolution, its section through the origin is a polygon,
/// and the axis of least depth is a normal of that polygon; all these normals are tested. If the
/// axes are not quite parallel, the depth along the best normal exceeds the least depth by at most
/// twice the sine of their angle times the size of b's core.
void test_revolution(const Problem& problem, AxisSearch& search) noexcept;

}  // namespace winnow::solver
