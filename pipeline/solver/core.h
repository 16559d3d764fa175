#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/shapes/support_core.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>

namespace winnow::solver {

using Vec = Eigen::Vector3d;
using Mat = Eigen::Matrix3d;

/// What is left of a shape when its rounding is taken away.
enum class CoreKind : std::uint8_t {
  point,
  segment,
  box,
  triangle,
  hull,
  cylinder,
  cone,
  support,
  half_space
};

/// A core at its place: in the axes of the world, in units of the problem. All of its functions
/// are exact but for a few roundings of the core's size.
struct Core {
  CoreKind kind = CoreKind::point;
  Mat rotation = Mat::Identity();
  Vec center = Vec::Zero();
  /// Box: half extents. Segment, cylinder, cone: radius, radius, half length.
  Vec half = Vec::Zero();
  double rounding = 0.0;
  /// No point of the shape is farther from the center.
  double size = 0.0;
  /// Triangle: from the center, turned.
  std::array<Vec, 3> corner{};
  /// Triangle: from corner i to the next, unit; turned from the shape's own numbers, so that it
  /// does not carry the rounding of corners far from the center. Zero where corners coincide.
  std::array<Vec, 3> side{};
  const HullShape* hull = nullptr;
  /// Ellipsoid, tapered capsule, own convex.
  SupportCore farthest;
  /// Two factors that bring a hull's or a support function's own units to the problem's: one could
  /// overflow.
  double unit[2] = {1.0, 1.0};
  /// Half-space: unit outward normal in the world, and offset from the center.
  Vec normal = Vec::UnitZ();
  double offset = 0.0;

  /// Cores with corners: everything but cylinders, cones, support functions and half-spaces.
  [[nodiscard]] bool is_polytope() const noexcept { return kind < CoreKind::cylinder; }
};

struct Range {
  double low;
  double high;
};

/// The first vertex of a hull that is farthest along a direction in the hull's frame, and how far.
std::uint32_t farthest_vertex(const HullShape& hull, const Vec& d, double& value) noexcept;

/// A point of the core that is farthest along `direction`.
[[nodiscard]] Vec support(const Core& core, const Vec& direction) noexcept;

/// Smallest and largest n . (x - center) over the core.
[[nodiscard]] Range project(const Core& core, const Vec& n) noexcept;

/// The largest alone.
[[nodiscard]] double highest(const Core& core, const Vec& n) noexcept;

/// The gap between the cores along a unit axis from a to b; negative where they overlap on it.
[[nodiscard]] double separation(const Core& a, const Core& b, const Vec& axis) noexcept;

/// A triangle inside of a cylinder or cone, in the plane of its axis and `direction`, that has the
/// supporting point and the line of the side through it. Other cores are returned as they are, and
/// so are these where the direction is that of their axis.
[[nodiscard]] Core meridian(const Core& core, const Vec& direction) noexcept;

// Corners, edges and faces of polytopes. Extents of zero make some of them coincide.
[[nodiscard]] std::uint32_t vertex_count(const Core& core) noexcept;
[[nodiscard]] Vec vertex(const Core& core, std::uint32_t i) noexcept;
[[nodiscard]] std::uint32_t edge_count(const Core& core) noexcept;
[[nodiscard]] std::array<std::uint32_t, 2> edge(const Core& core, std::uint32_t i) noexcept;

/// Directions of edges, each but once for a box; of any length, zero too. A cylinder's or cone's
/// axis counts as one.
[[nodiscard]] std::uint32_t direction_count(const Core& core) noexcept;
[[nodiscard]] Vec direction(const Core& core, std::uint32_t i) noexcept;

/// Unit face normals, one of each opposite pair for boxes and triangles; zero where a triangle has
/// none. A cylinder's or cone's cap counts as a face.
[[nodiscard]] std::uint32_t normal_count(const Core& core) noexcept;
[[nodiscard]] Vec normal(const Core& core, std::uint32_t i) noexcept;

/// Faces: 6 of a box, 1 of a triangle, those of a hull.
[[nodiscard]] std::uint32_t face_count(const Core& core) noexcept;
[[nodiscard]] std::uint32_t face_size(const Core& core, std::uint32_t face) noexcept;
[[nodiscard]] std::uint32_t face_vertex(const Core& core, std::uint32_t face,
                                        std::uint32_t i) noexcept;
/// The edge from vertex i of a face to the next.
[[nodiscard]] std::uint32_t face_edge(const Core& core, std::uint32_t face,
                                      std::uint32_t i) noexcept;
/// Unit and outward; either one for a triangle.
[[nodiscard]] Vec face_normal(const Core& core, std::uint32_t face) noexcept;

/// Unit vector along v, zero for zero. Neither overflows nor vanishes for any finite v.
[[nodiscard]] Vec unit(const Vec& v) noexcept;

/// Unit vector perpendicular to the unit vectors e and f, so exactly to e that projections along it
/// are right to rounding whatever the angle between them; zero where they are parallel.
[[nodiscard]] Vec perpendicular(const Vec& e, const Vec& f) noexcept;

/// Unit vector along the part of v that is perpendicular to the unit vector e; zero if there is
/// none.
[[nodiscard]] Vec without(const Vec& v, const Vec& e) noexcept;

inline constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Shares of a pair's noise (see Problem::noise). Iterations end where no more than the first is to
/// be gained; distances that differ by less than the second count as equal.
inline constexpr double kEnough = 0.125;
inline constexpr double kHardly = 0.25;

}  // namespace winnow::solver
