#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>

namespace winnow {

/// What exact arithmetic says about a pair.
enum class ExactVerdict : unsigned char {
  /// No point in common.
  separated,
  /// The boundaries touch, the interiors do not meet.
  touching,
  /// They share more than a boundary point.
  overlapping,
  /// A kind whose contact is not a rational predicate (cylinders, cones), or numbers beyond the
  /// range in which products of doubles are exact.
  undecided,
};

/// Whether two valid shapes at valid poses share a point, without any rounding: every double of the
/// shapes and poses is taken as the number it is, and a quaternion as the rotation of its exact
/// normalisation. `axis` is a direction (any length, in the axes of the world, from a to b) along
/// which the shapes are closest or overlap least, as far as double can tell: tried first.
///
/// Polytopes by separating axes (Gottschalk, 1996, for boxes; face normals and products of edges
/// for hulls; in-plane normals besides where one is flat), spheres, capsules and roundings by the
/// square of the distance of the cores, a rational number. Numbers are sums of doubles that do not
/// overlap (Shewchuk, 1997). For pairs whose sign double cannot tell: microseconds for small
/// shapes, more for hulls, where candidates are first pruned in double.
[[nodiscard]] ExactVerdict exact_overlap(const ShapeTables& tables, ShapeId a, const Pose& pose_a,
                                         ShapeId b, const Pose& pose_b,
                                         const double axis[3]) noexcept;

}  // namespace winnow
