#pragma once

// Cores of shapes, one per lane or one at a time, and rotations of vectors. core_kinds.wide.h
// computes with cores for each kind.

#include <winnow/pipeline/shapes.h>
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::hull {

inline constexpr int kCoreNumbers = 9;

/// Cores of one kind in their own frames, one per lane.
template <typename T>
struct CoreLanes {
  /// Box: half extents. Capsule, cylinder, cone: radius of the core, 0, half length. Triangle:
  /// three vertices. Ellipsoid: its radii, and the least radius of curvature, which is removed from
  /// the core and added to the rounding. Tapered capsule: the difference of the radii, z of the
  /// larger ball, z of the smaller ball; if the larger ball contains the smaller: 0, and twice z of
  /// the larger ball. Hulls and user shapes have no numbers.
  Lanes<T> number[kCoreNumbers];
  ShapeKind kind;
};

/// The core of one shape in its own frame.
struct CoreDesc {
  ShapeKind kind;
  /// The same numbers as in CoreLanes.
  double number[kCoreNumbers];
  /// Null unless the shape is a hull, and a user shape, respectively.
  const HullShape* hull;
  const SupportShape* own;
  double rounding;
  /// A point of the core.
  double center[3];
};

/// The cores of a block of pairs. For hulls and user shapes only their bounds are loaded, not their
/// points.
struct LoadedCores {
  CoreLanes<float> core;
  Lanes<float> rounding;
  /// Upper bound of the distance of the core's points from its origin.
  Lanes<float> reach;
  /// A central point of the core, and the radius of a ball around it that is inside the core;
  /// negative if no point of the core is available.
  Vec3<float> center;
  Lanes<float> inner;
};

/// Applies a rotation, or its inverse; one matrix per lane.
template <typename T>
[[gnu::always_inline]] static inline Vec3<T> turned(const Lanes<T>* m, const Vec3<T>& v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
          m[6] * v.x + m[7] * v.y + m[8] * v.z};
}
template <typename T>
[[gnu::always_inline]] static inline Vec3<T> turned_back(const Lanes<T>* m, const Vec3<T>& v) {
  return {m[0] * v.x + m[3] * v.y + m[6] * v.z, m[1] * v.x + m[4] * v.y + m[7] * v.z,
          m[2] * v.x + m[5] * v.y + m[8] * v.z};
}

}  // namespace winnow::WINNOW_ISA_NAME::hull
