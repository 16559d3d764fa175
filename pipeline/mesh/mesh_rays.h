#pragma once

#include "pipeline/mesh/mesh_traversal.h"

#include <cstdint>

namespace winnow {

/// Tests whether the ray crosses a triangle at a t in [low, high]. Returns `uncertain` if rounding
/// or the ray's slack may change the result.
[[nodiscard]] Crossing cross_triangle(const SurfaceRay& ray, const double (&corner)[3][3],
                                      SurfaceHit& hit) noexcept;

/// For a ray that crosses the triangle: returns whether it comes from the side from which the
/// corners run clockwise.
[[nodiscard]] bool comes_from_behind(const SurfaceRay& ray, const double (&corner)[3][3]) noexcept;

/// Passes to the visitor all triangles that each of the first `count` rays crosses or may cross at
/// some t in [0, its limit], roughly in order of t. A negative limit skips a ray. Rays and limits
/// are padded as RayColumns are. The visitor gets each ray's index.
void mesh_rays(const MeshView& mesh, const SurfaceRays& rays, const double* limits,
               std::uint32_t count, const RaySlotVisitor& visitor) noexcept;
/// As above, for one ray, with index 0.
void mesh_ray(const MeshView& mesh, const SingleSurfaceRay& ray, double limit,
              const RaySlotVisitor& visitor) noexcept;

}  // namespace winnow
