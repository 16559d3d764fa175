#pragma once

#include "pipeline/mesh/mesh_traversal.h"

#include <cstdint>

namespace winnow {

enum class Crossing : std::uint8_t { none, found, doubtful };

struct SurfaceHit {
  double t;
  /// At right angles to the triangle, against the ray, of any length.
  double normal[3];
};

/// Whether the ray meets a triangle at some t in [low, high], by the signs of the volumes between
/// it and the sides (Platis, Theoharis, "Fast ray-tetrahedron intersection using Pluecker
/// coordinates", 2003). Doubtful where rounding or the ray's slack may change the answer.
[[nodiscard]] Crossing cross_triangle(const SurfaceRay& ray, const double (&corner)[3][3],
                                      double low, double high, SurfaceHit& hit) noexcept;

/// True if a ray that meets a triangle comes from the side from which its corners run clockwise.
[[nodiscard]] bool comes_from_behind(const SurfaceRay& ray, const double (&corner)[3][3]) noexcept;

/// Slots of all triangles that each of the first `count` rays may meet at some t in [0, its limit],
/// and few others, roughly in the order in which it does. A limit below zero leaves a ray out. Rays
/// and limits are filled up as RayColumns are. The visitor knows rays by their index, and is
/// otherwise as those of mesh_traversal.h.
void mesh_rays(const MeshView& mesh, const SurfaceRays& rays, const double* limits,
               std::uint32_t count, const RaySlotVisitor& visitor) noexcept;
/// The same of one ray, whose index is 0.
void mesh_ray(const MeshView& mesh, const LoneSurfaceRay& ray, double limit,
              const RaySlotVisitor& visitor) noexcept;

}  // namespace winnow
