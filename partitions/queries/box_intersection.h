#pragma once

#include <winnow/core/regions.h>
#include <winnow/core/volumes.h>
#include "partitions/queries/region.kernel.h"

#include <Eigen/Core>

namespace winnow {

// Tests in double of a shape against the box of a row: the final decision for rows that pass the
// float tests. A box is six floats, low then high; +-FLT_MAX means infinity. Within a few roundings
// of the coordinates, each test errs on the side of overlap.

/// A capsule (or ball, if its ends are equal) that moves along direction * [0, max_t].
struct MovingCapsule {
  Capsule capsule;
  Eigen::Vector3d direction;
  double max_t;
};

/// Returns the first t >= from at which the shape touches the box, or a negative number; `shape` is
/// a MovingCapsule. The distance from the box is a convex function of t, so Newton steps from the
/// left never pass the first root. They converge quadratically, or linearly if the capsule only
/// grazes the box.
[[nodiscard]] double touch_capsule(const void* shape, const float* box, double from);

// `region` points to a Sphere, Capsule, OrientedBox or std::span<const Plane>.
[[nodiscard]] Containment classify_sphere(const void* region, const float* box);
[[nodiscard]] Containment classify_capsule(const void* region, const float* box);
/// Separating axis test (SAT) with 15 axes (Gottschalk, Lin, Manocha, "OBBTree", SIGGRAPH 1996).
[[nodiscard]] Containment classify_oriented_box(const void* region, const float* box);
[[nodiscard]] Containment classify_planes(const void* region, const float* box);

}  // namespace winnow
