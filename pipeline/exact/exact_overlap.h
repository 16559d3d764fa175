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
  /// A kind whose contact is not a rational predicate (cylinders, cones, those known
  /// by a support function), or numbers beyond the
  /// range in which products of doubles are exact.
  undecided,
};

/// Of the sign of a distance.
[[nodiscard]] constexpr ExactVerdict verdict_of(int sign) noexcept {
  return sign > 0   ? ExactVerdict::separated
         : sign < 0 ? ExactVerdict::overlapping
                    : ExactVerdict::touching;
}

/// Whether two valid shapes at valid poses share a point, without any rounding: every double of the
/// shapes and poses is taken as the number it is, and a quaternion as the rotation of its exact
/// normalisation. `axis` is a direction (any length, in the axes of the world, from a to b) along
/// which the shapes are closest or overlap least, as far as double can tell: tried first.
///
/// Cores are hulls of points, and so is the set of their differences: the algorithm of Gilbert,
/// Johnson and Keerthi (1988) without rounding descends to its point nearest to the origin,
/// whatever the dimension and however the shape's faces were merged. Without rounding radii that is
/// a yes or no, and where the origin is on the boundary of what was found, a supporting plane is
/// sought; with them the square of the distance, a rational number, is compared. Coordinates are
/// multiplied by the squares of both quaternions' lengths, so that there are only sums and
/// products. Half-spaces by the lowest point of the other. Shapes whose frames are aligned by
/// closed forms. Other cylinders and cones are decided where `axis` proves that they are apart,
/// where polygons inscribed in their discs overlap, or where both touch. Pairs whose numbers span
/// more than some 1e200 are decided where they are boxes without rounding, or where one of a few
/// planes proves them apart. For pairs whose sign double cannot tell: 5 to 100 microseconds, more
/// for large hulls, whose vertices are first sifted in double; next to nothing where
/// `aligned_overlap` decides.
[[nodiscard]] ExactVerdict exact_overlap(const ShapeTables& tables, ShapeId a, const Pose& pose_a,
                                         ShapeId b, const Pose& pose_b,
                                         const double axis[3]) noexcept;

}  // namespace winnow
