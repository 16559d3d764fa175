#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>

namespace winnow {

/// Result of an exact overlap test.
enum class ExactVerdict : unsigned char {
  /// No point in common.
  separated,
  /// The boundaries touch, the interiors are disjoint.
  touching,
  /// The interiors overlap.
  overlapping,
  /// Not decided: the pair has a shape given by a support function, or a cylinder or cone in a
  /// general position that no proof below covers, or the exponents of the input span too wide a
  /// range.
  undecided,
};

/// Converts the sign of a distance to a verdict.
[[nodiscard]] constexpr ExactVerdict verdict_of(int sign) noexcept {
  return sign > 0   ? ExactVerdict::separated
         : sign < 0 ? ExactVerdict::overlapping
                    : ExactVerdict::touching;
}

/// Decides without rounding whether two valid shapes at valid poses overlap. Each double of the
/// shapes and poses is taken as the exact number it stores, and a quaternion as the rotation of its
/// exact normalization. `axis` is tested first: a direction (any length, world axes, from a to b)
/// along which the shapes are closest or overlap least according to the search in double.
///
/// Methods: axis-aligned shapes by closed forms (aligned_overlap). Half-spaces by the lowest point
/// of the other shape. All others by GJK (Gilbert, Johnson and Keerthi 1988) in exact arithmetic on
/// the Minkowski difference of the cores, which are convex hulls of points. Without rounding radii,
/// GJK decides whether the origin is in the difference; if the origin is on the boundary of the
/// last simplex, a supporting plane is searched. With rounding radii, the squared distance, a
/// rational number, is compared with the squared radius. Coordinates are multiplied by the squared
/// lengths of both quaternions, so that only sums and products are needed.
///
/// Other cylinders and cones are decided only if `axis` separates them, if polygons inscribed in
/// their discs overlap, or if both touch: the cores along `axis`, and the polygons. Pairs whose
/// numbers span more than about 1e200 are decided only if both are boxes without rounding, or if
/// one of a few planes separates them.
///
/// Costs O(vertices) per GJK step; products in double exclude most vertices of large hulls. The
/// solver calls this only if the sign is uncertain in double.
[[nodiscard]] ExactVerdict exact_overlap(const ShapeTables& tables, ShapeId a, const Pose& pose_a,
                                         ShapeId b, const Pose& pose_b,
                                         const double axis[3]) noexcept;

}  // namespace winnow
