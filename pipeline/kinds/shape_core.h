#pragma once

// The core of a shape: the shape without its rounding. Each kind makes its core in core_of (see
// kinds.h); the solver and the exact tests only use cores.

#include <winnow/pipeline/shapes.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

namespace winnow {

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

/// The core of an ellipsoid, a tapered capsule or a user shape, given by its support function, in
/// the shape's frame and units.
struct SupportCore {
  using Vec = Eigen::Vector3d;

  /// Support function: a farthest point along a unit direction, with an error of a few roundings of
  /// `radius`. The result is always finite and within `radius` of the origin.
  Vec (*function)(const void* shape, const Vec& direction) noexcept = nullptr;
  const void* shape = nullptr;
  ShapeKind kind = ShapeKind::support;
  /// Upper bound on the distance of the core's points from the origin.
  double radius = 0.0;
  double rounding = 0.0;

  [[nodiscard]] Vec farthest(const Vec& direction) const noexcept {
    return function(shape, direction);
  }
};

/// A core in the frame and the units of its shape. It refers to the shape, which must outlive it.
struct ShapeCore {
  CoreKind kind = CoreKind::point;
  /// Box: half extents. Segment, cylinder, cone: radius, radius, half length.
  Eigen::Vector3d half = Eigen::Vector3d::Zero();
  double rounding = 0.0;
  /// The largest of the shape's numbers, or a bound on the distance of its points from its
  /// position: lengths are scaled by it. Finite even if the numbers of the shape are not.
  double largest = 0.0;
  // The shape, if the core is of this kind; else null.
  const TriangleShape* triangle = nullptr;
  const HullShape* hull = nullptr;
  const HalfSpaceShape* half_space = nullptr;
  SupportCore support;

  /// A core that is given by `half` and `rounding`.
  [[nodiscard]] static ShapeCore of_lengths(CoreKind kind, const Eigen::Vector3d& half,
                                            double rounding) noexcept {
    ShapeCore core;
    core.kind = kind;
    core.half = half;
    core.rounding = rounding;
    core.largest = std::max(half.maxCoeff(), rounding);
    return core;
  }
  [[nodiscard]] static ShapeCore of_support(const SupportCore& support) noexcept {
    ShapeCore core;
    core.kind = CoreKind::support;
    core.rounding = support.rounding;
    core.largest = std::max(support.radius, support.rounding);
    core.support = support;
    return core;
  }
};

}  // namespace winnow
