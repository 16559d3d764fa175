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

/// A closed part of space to be asked about; every one of these converts to it. A span of planes is
/// the set of points inside all of them (empty: all of space); the planes must outlive the call. An
/// Aabb may reach to infinity.
using Region =
    std::variant<Vec3f, Aabb, OrientedBox, Sphere, Capsule, Frustum, std::span<const Plane>>;

}  // namespace winnow
