#pragma once

#include <winnow/core/volumes.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/kinds/support_extent.h"
#include "pipeline/shapes/frame.h"

namespace winnow::mid {

using winnow::SupportExtent;

/// SupportExtent along any finite direction d, in the shape's own frame. The error is a few
/// roundings of `scale`. Infinite for a half-space.
[[nodiscard]] SupportExtent extent(const ShapeTables& tables, ShapeId shape, const Vec& d) noexcept;

/// SupportExtent::low only.
[[nodiscard]] double lowest(const ShapeTables& tables, ShapeId shape, const Vec& d) noexcept;

/// An AABB of { linear * x + offset : x in the shape }, for a convex shape, grown by the image of a
/// ball of radius `grow` and by a bound on rounding errors.
[[nodiscard]] Box3 box_under(const ShapeTables& tables, ShapeId shape, const Mat& linear,
                             const Vec& offset, double grow) noexcept;
/// As above for the points of a box.
[[nodiscard]] Box3 box_under(const Box3& box, const Mat& linear, const Vec& offset,
                             double grow) noexcept;

/// Upper bound on the distance of the shape's points from its origin, up to a few roundings;
/// infinite for a half-space.
[[nodiscard]] double radius_of(const ShapeTables& tables, ShapeId shape) noexcept;

/// The rounding radius of the shape: the radius for a sphere or capsule, the `rounding` member for
/// others.
[[nodiscard]] double rounding_of(const ShapeTables& tables, ShapeId shape) noexcept;

}  // namespace winnow::mid
