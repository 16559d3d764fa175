#include "pipeline/mesh/mesh_rays.h"

#include "pipeline/mesh/mesh_traversal.h"

#include <Eigen/Geometry>

namespace winnow {

Crossing cross_triangle(const SurfaceRay& ray, const double (&corner)[3][3],
                        SurfaceHit& hit) noexcept {
  return mesh_kernels().cross(ray, corner, hit);
}

bool comes_from_behind(const SurfaceRay& ray, const double (&corner)[3][3]) noexcept {
  using Eigen::Vector3d;
  const Vector3d at = Vector3d::Map(corner[0]);
  const Vector3d normal = (Vector3d::Map(corner[1]) - at).cross(Vector3d::Map(corner[2]) - at);
  return normal.dot(Vector3d::Map(ray.direction)) > 0.0;
}

void mesh_rays(const MeshView& mesh, const SurfaceRays& rays, const double* limits,
               std::uint32_t count, const RaySlotVisitor& visitor) noexcept {
  if (mesh.triangle_count == 0 || count == 0) return;
  mesh_kernels().rays(mesh, rays, limits, count, visitor);
}

void mesh_ray(const MeshView& mesh, const SingleSurfaceRay& ray, double limit,
              const RaySlotVisitor& visitor) noexcept {
  if (mesh.triangle_count != 0) mesh_kernels().ray(mesh, ray, limit, visitor);
}

}  // namespace winnow
