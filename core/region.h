#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/capsule.h>
#include <winnow/core/frustum.h>
#include <winnow/core/oriented_box.h>
#include <winnow/core/plane.h>
#include <winnow/core/sphere.h>
#include <winnow/core/vec3.h>

#include <span>
#include <variant>

namespace winnow {

/// A closed region of space for queries; each alternative converts to it implicitly. A span of
/// planes is the set of points inside all of them, which is all of space if the span is empty; the
/// planes must outlive the call. An Aabb may extend to infinity.
using Region =
    std::variant<Vec3f, Aabb, OrientedBox, Sphere, Capsule, Frustum, std::span<const Plane>>;

}  // namespace winnow
