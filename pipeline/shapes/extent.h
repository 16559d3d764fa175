#pragma once

#include <winnow/core/aabb.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/shapes/frame.h"

namespace winnow::mid {

/// The values of d . x over a shape, and how large the numbers were that made them.
struct Extent {
  double low;
  double high;
  double scale;
};

/// Along any finite direction in the shape's own frame; that of a half-space is endless. Within a
/// few roundings of `scale`.
[[nodiscard]] Extent extent(const ShapeTables& tables, ShapeId shape, const Vec& d) noexcept;

/// The least value alone.
[[nodiscard]] double lowest(const ShapeTables& tables, ShapeId shape, const Vec& d) noexcept;

/// The box of linear * x + offset over a convex shape, grown by the image of a ball of radius
/// `grow`, and by what rounding may have taken.
[[nodiscard]] Box box_under(const ShapeTables& tables, ShapeId shape, const Mat& linear,
                            const Vec& offset, double grow) noexcept;
/// The same of a box.
[[nodiscard]] Box box_under(const Box& box, const Mat& linear, const Vec& offset,
                            double grow) noexcept;

/// No point of the convex shape is farther from its origin, but for a few roundings; infinite for a
/// half-space.
[[nodiscard]] double radius_of(const ShapeTables& tables, ShapeId shape) noexcept;

/// How much of it is rounding: the radius of a sphere or capsule.
[[nodiscard]] double rounding_of(const ShapeTables& tables, ShapeId shape) noexcept;

}  // namespace winnow::mid
