#pragma once

#include "pipeline/mesh/mesh_traversal.h"

#include <cstdint>

namespace winnow {

/// Whether the ray meets a triangle at a t that counts. Doubtful where rounding or the ray's slack
/// may change the answer.
[[nodiscard]] Crossing cross_triangle(const SurfaceRay& ray, const double (&corner)[3][3],
                                      SurfaceHit& hit) noexcept;

/// True if a ray that meets a triangle comes from the side from which its corners run clockwise.
[[nodiscard]] bool comes_from_behind(const SurfaceRay& ray, const double (&corner)[3][3]) noexcept;

/// Shows all triangles that each of the first `count` rays meets or may meet at some t in [0, its
/// limit], roughly in the order in which it does. A limit below zero leaves a ray out. Rays and
/// limits are filled up as RayColumns are. The visitor knows rays by their index.
void mesh_rays(const MeshView& mesh, const SurfaceRays& rays, const double* limits,
               std::uint32_t count, const RaySlotVisitor& visitor) noexcept;
/// The same of one ray, whose index is 0.
void mesh_ray(const MeshView& mesh, const LoneSurfaceRay& ray, double limit,
              const RaySlotVisitor& visitor) noexcept;

}  // namespace winnow
