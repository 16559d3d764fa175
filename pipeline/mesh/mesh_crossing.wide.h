#pragma once

// A ray and a triangle in double, without fused operations: the same on every instruction set.

#include "pipeline/mesh/mesh_view.h"
#include "pipeline/mesh/surface_rays.h"
#include "simd/lanes/corners.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// Whether the line of a ray passes a triangle by for certain, by the rule of cross_triangle: two
/// of its volumes with the sides have different signs, whatever rounding and slack do.
template <std::uint32_t Room>
[[gnu::always_inline]] inline bool passes_by(const SurfaceRayColumns<Room>& rays, std::uint32_t ray,
                                             const MeshView& mesh, std::uint32_t slot) {
  using D = CornerDoubles;
  using V = Vec3<double, D::kParts>;
  const auto& start = rays.ray.origin;
  const auto& way = rays.ray.direction;
  const V direction{way[0][ray], way[1][ray], way[2][ray]};
  const auto at = [&](int k) { return mesh.vertex + std::size_t{3} * mesh.corner[k][slot]; };
  D corner[3];
  load_points(at(0), at(1), at(2), corner);
  const V from =
      V{corner[0], corner[1], corner[2]} - V{start[0][ray], start[1][ray], start[2][ray]};
  const D length = taxicab(from);
  const D after = of_next(length);
  const D far = length + after + of_next(after);
  const D doubt = taxicab(direction) * far * (D(0x1p-48) * far + D(4.0) * D(rays.slack[ray]));
  const V next{of_next(from.x), of_next(from.y), of_next(from.z)};
  const D volume = dot(cross(from, direction), next);
  return (bits(volume > doubt) & kThreeCorners) != 0 &&
         (bits(volume < -doubt) & kThreeCorners) != 0;
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
