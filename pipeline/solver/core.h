#pragma once

// The core of a shape: the shape without its rounding, which the solver treats separately. See
// problem.h for the frame and the units.

#include <winnow/core/eigen.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/kinds/shape_core.h"
#include "pipeline/solver/scale.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>

namespace winnow::solver {

using Vec = Eigen::Vector3d;
using Mat = Eigen::Matrix3d;

/// A core in world axes, scaled to the units of its Problem. All functions of a core are exact up
/// to a few roundings relative to the core's size.
struct Core {
  /// As ShapeCore::kind.
  ShapeKind kind = ShapeKind::sphere;
  Mat rotation = Mat::Identity();
  Vec center = Vec::Zero();
  /// Polytope in a box: half extents. Segment, cylinder, cone: (radius, radius, half length).
  Vec half = Vec::Zero();
  double rounding = 0.0;
  /// Upper bound of the distance of the shape's points from `center`, rounding included.
  double size = 0.0;
  /// Triangle: relative to the center, in world axes.
  std::array<Vec, 3> corner{};
  /// Triangle: unit vector from corner i to the next, zero if the corners coincide. Subtracted in
  /// the triangle's frame, then rotated: the difference of two rotated corners far from the center
  /// would have their rounding errors.
  std::array<Vec, 3> side{};
  /// Polytope in a box.
  const CornerTable* corners = nullptr;
  const HullShape* hull = nullptr;
  /// Ellipsoid, tapered capsule or user shape.
  SupportCore farthest;
  /// Scales the lengths of a hull or a support function to the problem's units.
  Scale scale{0};
  /// Half-space: unit outward normal in world axes, and offset of the plane from the center.
  Vec normal = Vec::UnitZ();
  double offset = 0.0;
};

struct AxisRange {
  double low;
  double high;
};

/// The vertices at the ends of an edge.
using Edge = std::array<std::uint32_t, 2>;

/// Returns the first of the hull's vertices that are farthest along `d`, a direction in the hull's
/// frame; `value` receives its dot product with `d`.
std::uint32_t farthest_vertex(const HullShape& hull, const Vec& d, double& value) noexcept;

/// Returns a point of the core that is farthest along `direction`.
[[nodiscard]] Vec support(const Core& core, const Vec& direction) noexcept;

/// Smallest and largest n . (x - center) over the core.
[[nodiscard]] AxisRange project(const Core& core, const Vec& n) noexcept;

/// As `project`, but returns only the largest.
[[nodiscard]] double highest(const Core& core, const Vec& n) noexcept;

/// Returns the gap between the cores along a unit axis from a to b; negative if their projections
/// overlap.
[[nodiscard]] double separation(const Core& a, const Core& b, const Vec& axis) noexcept;

/// Returns a triangle inside a cylinder or cone, in the plane of its axis and `direction`, that
/// contains the supporting point and the line of the side through it. Other cores are returned
/// unchanged, and so are cylinders and cones if `direction` runs along their axis.
[[nodiscard]] Core meridian(const Core& core, const Vec& direction) noexcept;

/// True for cores with corners: all but cylinders, cones, support functions and half-spaces.
[[nodiscard]] bool is_polytope(const Core& core) noexcept;

// Corners, edges and faces of polytopes. If extents are zero, some of them coincide.
[[nodiscard]] std::uint32_t vertex_count(const Core& core) noexcept;
[[nodiscard]] Vec vertex(const Core& core, std::uint32_t i) noexcept;
[[nodiscard]] std::uint32_t edge_count(const Core& core) noexcept;
[[nodiscard]] Edge edge(const Core& core, std::uint32_t i) noexcept;

/// Directions of the edges, of any length, which may be zero. A box has three, as parallel edges
/// count once; a cylinder or cone has one, its axis.
[[nodiscard]] std::uint32_t direction_count(const Core& core) noexcept;
[[nodiscard]] Vec direction(const Core& core, std::uint32_t i) noexcept;

/// Unit face normals; of opposite faces of a box or triangle only one. The normal of a triangle
/// without area is zero. A cylinder or cone has one, the normal of its cap.
[[nodiscard]] std::uint32_t normal_count(const Core& core) noexcept;
[[nodiscard]] Vec normal(const Core& core, std::uint32_t i) noexcept;

/// Faces: 6 for a box, 1 for a triangle, all faces of a hull.
[[nodiscard]] std::uint32_t face_count(const Core& core) noexcept;
[[nodiscard]] std::uint32_t face_size(const Core& core, std::uint32_t face) noexcept;
[[nodiscard]] std::uint32_t face_vertex(const Core& core, std::uint32_t face,
                                        std::uint32_t i) noexcept;
/// The edge from vertex i of a face to the next.
[[nodiscard]] std::uint32_t face_edge(const Core& core, std::uint32_t face,
                                      std::uint32_t i) noexcept;
/// Unit and outward; for a triangle either of its two normals.
[[nodiscard]] Vec face_normal(const Core& core, std::uint32_t face) noexcept;

/// Shrinks a cylinder, so that a body with the returned rounding around it fits in the cylinder;
/// the rounding is the largest possible. Returns 0 for other cores, which do not change.
[[nodiscard]] double inscribe(Core& core) noexcept;

/// Returns the unit vector along v, or zero if v is zero. Neither overflows nor underflows for any
/// finite v.
[[nodiscard]] Vec unit(const Vec& v) noexcept;

/// Returns a unit vector perpendicular to the unit vectors e and f, or zero if they are parallel.
/// It is perpendicular to e to full precision whatever the angle between e and f, so that
/// projections onto it are right to rounding.
[[nodiscard]] Vec perpendicular(const Vec& e, const Vec& f) noexcept;

/// Returns the unit vector along the part of v that is perpendicular to the unit vector e, or zero
/// if there is none.
[[nodiscard]] Vec without(const Vec& v, const Vec& e) noexcept;

inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Fractions of a pair's noise (see Problem::noise). Iterations end if at most kConvergence of it
/// can be gained; distances that differ by less than kTieTolerance of it count as equal.
inline constexpr double kConvergence = 0.125;
inline constexpr double kTieTolerance = 0.25;

}  // namespace winnow::solver
