#pragma once

#include "pipeline/solver/core.h"
#include "pipeline/solver/gjk.h"
#include "pipeline/solver/problem.h"

#include <limits>

namespace winnow::solver {

/// The best of the axes that were looked at: the unit one, from a to b, along which the cores are
/// farthest apart or overlap least. Its separation is a lower bound of their signed distance.
class AxisSearch {
 public:
  AxisSearch(const Core& a, const Core& b) noexcept : a_(a), b_(b) {}

  /// The axis and its opposite; a zero vector is passed over.
  void look(const Vec& axis) noexcept;

  [[nodiscard]] const Vec& axis() const noexcept { return axis_; }
  [[nodiscard]] double separation() const noexcept { return separation_; }

 private:
  const Core& a_;
  const Core& b_;
  Vec axis_ = Vec::Zero();
  double separation_ = -std::numeric_limits<double>::infinity();
};

/// Axes that the features of a simplex give: perpendicular to what its points span on a and on b.
/// They are right to rounding where the vector between the closest points is too short to have a
/// good direction.
void look_at_simplex(const GjkResult& found, AxisSearch& search) noexcept;

/// Face normals of both cores, and caps.
void look_at_normals(const Problem& problem, AxisSearch& search) noexcept;

/// Face normals of both cores and products of their edges; caps and axes of cylinders and cones.
/// Where polytopes overlap, one of these is the axis of least depth; where they do not, one of
/// these separates them. Between hulls only edges that make a face of the Minkowski difference
/// (Gregorius, "The separating axis test between convex polyhedra", 2013), and of those only what
/// may beat the best so far. O(edges of a x edges of b); false if that is above a bound of some
/// millions and products of edges were left out.
bool look_at_features(const Problem& problem, AxisSearch& search) noexcept;

/// The most products of directions that look_at_features tries.
inline constexpr std::uint64_t kMostEdgePairs = 4'000'000;

/// The sine of the angle between the axes of two points, segments, cylinders or cones: 0 for a
/// point, infinite for other cores.
[[nodiscard]] double turn_of_revolution(const Problem& problem) noexcept;

/// For points, segments, cylinders and cones whose axes are parallel: their difference is a body of
/// revolution, its outline through the origin a polygon, and the axis of least depth one of that
/// polygon's normals. Looks at all of them, or at what they would be if the axes were parallel: the
/// best is then within twice the turn times the size of b's core.
void look_at_revolution(const Problem& problem, AxisSearch& search) noexcept;

}  // namespace winnow::solver
