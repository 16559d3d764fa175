#pragma once

// Functions of the struct of each kind of convex shape, one header for each kind. All kinds have
// these functions, overloaded by struct:
//
//   SupportExtent extent_of(shape, direction)  range along an AnyDirection or UnitDirection
//   double radius_of(shape)        upper bound on the distance of points from the shape's origin
//   double rounding_of(shape)      rounding radius: the radius of a sphere or capsule
//   double inner_radius_of(shape)  radius of a ball inside the shape about its origin (for a hull,
//                                  about its centre), or 0
//   double size_of(shape)          the largest length of the shape, to which rays are scaled
//   ShapeCore core_of(shape)       the core, for the solver and exact tests

#include "pipeline/kinds/box.h"
#include "pipeline/kinds/capsule.h"
#include "pipeline/kinds/cone.h"
#include "pipeline/kinds/cylinder.h"
#include "pipeline/kinds/ellipsoid.h"
#include "pipeline/kinds/half_space.h"
#include "pipeline/kinds/hull.h"
#include "pipeline/kinds/sphere.h"
#include "pipeline/kinds/support.h"
#include "pipeline/kinds/tapered_capsule.h"
#include "pipeline/kinds/triangle.h"
#include "pipeline/kinds/with_shape.h"

namespace winnow {

/// The core of a shape by id; it refers to the shape in the tables.
[[nodiscard]] inline ShapeCore core_of(const ShapeTables& tables, ShapeId id) noexcept {
  return with_shape(tables, id, [](const auto& shape) { return core_of(shape); });
}

}  // namespace winnow
