#pragma once

#include <winnow/pipeline/shapes.h>
#include "pipeline/rays/ray_parts.h"

namespace winnow {

// Where a ray in a shape's frame enters it. Lengths of the shape count `scale` times (a power of
// two), as those of the ray already do.

[[nodiscard]] FirstEntry enter(const LocalRay& ray, const SphereShape& sphere,
                               double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const CapsuleShape& capsule,
                               double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const BoxShape& box, double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const CylinderShape& cylinder,
                               double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const ConeShape& cone, double scale) noexcept;
/// O(faces + edges).
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const HullShape& hull, double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const TriangleShape& triangle,
                               double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const HalfSpaceShape& half_space,
                               double scale) noexcept;

}  // namespace winnow
