#pragma once

#include "pipeline/mesh/mesh_traversal.h"

#include <cstdint>
#include <span>

namespace winnow {

/// A ray in the own frame of a mesh or height field, whose length along it is about that of t.
struct SurfaceRay {
  double origin[3];
  /// The largest component is in [1/2, 1).
  double direction[3];
  /// Wherever it is near the surface, the true ray is no farther from this one.
  double slack;
};

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

/// Slots of all triangles that each ray may meet at some t in [0, its limit], and few others,
/// roughly in the order in which it does. At most kRaysAtOnce rays, each with a limit; the visitor
/// knows them by their index, and is otherwise as those of mesh_traversal.h.
void mesh_rays(const MeshView& mesh, std::span<const SurfaceRay> rays, const double* limits,
               const RaySlotVisitor& visitor) noexcept;

}  // namespace winnow
