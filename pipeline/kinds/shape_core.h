#pragma once

// The core of a shape: the shape without its rounding. Each kind makes its core in core_of (see
// kinds.h); the solver and the exact tests only use cores.

#include <winnow/core/eigen.h>
#include <winnow/pipeline/shapes.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

namespace winnow {

/// The corners, edges and faces of a polytope inside a box, some corners of which are its corners.
struct CornerTable {
  static constexpr std::uint32_t kMaxCorners = 8;
  std::uint32_t corners;
  /// Coordinates of the corners, in half extents.
  std::int8_t corner[kMaxCorners][3];
  std::uint32_t edges;
  /// The corners at the ends, the lower number first.
  std::uint8_t edge[12][2];
  std::uint32_t faces;
  std::uint8_t face_size[6];
  /// Counter-clockwise seen from outside.
  std::uint8_t face[6][4];
  /// Outward normals if the box is a cube.
  std::int8_t normal[6][3];
};

/// The core of an ellipsoid, a tapered capsule or a user shape, given by its support function, in
/// the shape's frame and units.
struct SupportCore {
  using Vec = Eigen::Vector3d;

  /// Support function: a farthest point along a unit direction, with an error of a few roundings of
  /// `radius`. The result is always finite and within `radius` of the origin.
  Vec (*function)(const void* shape, const Vec& direction) noexcept = nullptr;
  const void* shape = nullptr;
  /// Upper bound on the distance of the core's points from the origin.
  double radius = 0.0;
  double rounding = 0.0;

  [[nodiscard]] Vec farthest(const Vec& direction) const noexcept {
    return function(shape, direction);
  }
};

/// A core in the frame and the units of its shape. It refers to the shape, which must outlive it.
struct ShapeCore {
  /// The kind of a shape that has such a core: sphere for a point, capsule for a segment.
  ShapeKind kind = ShapeKind::sphere;
  /// Polytope in a box: half extents. Segment, cylinder, cone: radius, radius, half length.
  Eigen::Vector3d half = Eigen::Vector3d::Zero();
  double rounding = 0.0;
  /// The largest of the shape's numbers, or a bound on the distance of its points from its
  /// position: lengths are scaled by it. Finite even if the numbers of the shape are not.
  double largest = 0.0;
  // The data of the core, if it is of this kind; else null.
  const CornerTable* corners = nullptr;
  const TriangleShape* triangle = nullptr;
  const HullShape* hull = nullptr;
  const HalfSpaceShape* half_space = nullptr;
  SupportCore support;

  /// True for the convex hull of two discs about the z axis: a cylinder, or a cone, the upper disc
  /// of which has no radius.
  [[nodiscard]] bool has_discs() const noexcept {
    return kind == ShapeKind::cylinder || kind == ShapeKind::cone;
  }
  [[nodiscard]] double top() const noexcept { return kind == ShapeKind::cone ? 0.0 : half.x(); }

  /// A core that is given by `half` and `rounding`.
  [[nodiscard]] static ShapeCore of_lengths(ShapeKind kind, const Eigen::Vector3d& half,
                                            double rounding) noexcept {
    ShapeCore core;
    core.kind = kind;
    core.half = half;
    core.rounding = rounding;
    core.largest = std::max(half.maxCoeff(), rounding);
    return core;
  }
  /// A polytope in the box of half extents `half`.
  [[nodiscard]] static ShapeCore of_corners(ShapeKind kind, const CornerTable& corners,
                                            const Eigen::Vector3d& half, double rounding) noexcept {
    ShapeCore core = of_lengths(kind, half, rounding);
    core.corners = &corners;
    return core;
  }
  [[nodiscard]] static ShapeCore of_support(ShapeKind kind, const SupportCore& support) noexcept {
    ShapeCore core;
    core.kind = kind;
    core.rounding = support.rounding;
    core.largest = std::max(support.radius, support.rounding);
    core.support = support;
    return core;
  }
};

}  // namespace winnow
