#pragma once

#include <winnow/core/capsule.h>
#include <winnow/core/oriented_box.h>
#include <winnow/core/plane.h>
#include <winnow/core/sphere.h>
#include "partitions/queries/region.kernel.h"

#include <Eigen/Core>
#include <span>

namespace winnow {

// What decides, in double, whether a shape meets the box of a row. Boxes are six floats: low, high;
// an end of +-FLT_MAX stands for infinity. Each errs to the side of meeting by a few roundings of
// the coordinates that take part.

/// A capsule (or a ball: ends that are equal) that moves along direction * [0, max_t].
struct MovingCapsule {
  Capsule capsule;
  Eigen::Vector3d direction;
  double max_t;
};

/// The first t >= from at which it touches the box, or a negative number; `shape` is a
/// MovingCapsule. The distance from the box is a convex function of t, so Newton's steps from the
/// left never pass the first root; they converge quadratically, and by halves where the capsule
/// only grazes the box.
[[nodiscard]] double touch_capsule(const void* shape, const float* box, double from);

// `region` is a Sphere, Capsule, OrientedBox, std::span<const Plane>.
[[nodiscard]] Containment meet_sphere(const void* region, const float* box);
[[nodiscard]] Containment meet_capsule(const void* region, const float* box);
/// Separating axes: three of the box, three of the oriented one, nine products of edges
/// (Gottschalk, Lin, Manocha, "OBBTree", SIGGRAPH 1996).
[[nodiscard]] Containment meet_oriented_box(const void* region, const float* box);
[[nodiscard]] Containment meet_planes(const void* region, const float* box);

}  // namespace winnow
