#include "pipeline/mesh/mesh_rays.h"

#include "pipeline/mesh/mesh_traversal.h"
#include "pipeline/shapes/accurate_cross.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

using Eigen::Vector3d;

/// The product of two edges of a triangle, at right angles to both. Where no more than three bits
/// of the products cancel, they need no more care.
Vector3d normal_of(const Vector3d& a, const Vector3d& b) noexcept {
  const Vector3d plus(a.y() * b.z(), a.z() * b.x(), a.x() * b.y());
  const Vector3d minus(a.z() * b.y(), a.x() * b.z(), a.y() * b.x());
  const Vector3d normal = plus - minus;
  constexpr double kLeastLeft = 0.125;
  const double size = plus.cwiseAbs().sum() + minus.cwiseAbs().sum();
  return normal.cwiseAbs().sum() > kLeastLeft * size ? normal : accurate_cross(a, b);
}

}  // namespace

Crossing cross_triangle(const SurfaceRay& ray, const double (&corner)[3][3], double low,
                        double high, SurfaceHit& hit) noexcept {
  const Vector3d origin = Vector3d::Map(ray.origin);
  const Vector3d direction = Vector3d::Map(ray.direction);
  const Vector3d a = Vector3d::Map(corner[0]) - origin;
  const Vector3d b = Vector3d::Map(corner[1]) - origin;
  const Vector3d c = Vector3d::Map(corner[2]) - origin;
  const double far = a.cwiseAbs().sum() + b.cwiseAbs().sum() + c.cwiseAbs().sum();
  const double doubt = direction.cwiseAbs().sum() * far * (0x1p-48 * far + 4.0 * ray.slack);
  const double volume[3] = {direction.dot(c.cross(b)), direction.dot(a.cross(c)),
                            direction.dot(b.cross(a))};
  const double least = std::min({volume[0], volume[1], volume[2]});
  const double greatest = std::max({volume[0], volume[1], volume[2]});
  if (least < -doubt && greatest > doubt) return Crossing::none;
  if (!(least > doubt || greatest < -doubt)) return Crossing::doubtful;
  Vector3d normal = normal_of(Vector3d::Map(corner[1]) - Vector3d::Map(corner[0]),
                              Vector3d::Map(corner[2]) - Vector3d::Map(corner[0]));
  const double rate = normal.dot(direction);
  const double t = normal.dot(a) / rate;
  const double error = normal.cwiseAbs().sum() * (2.0 * ray.slack + 0x1p-48 * far) / std::abs(rate);
  if (t < low - error || t > high + error) return Crossing::none;
  if (!(t > low + error && t < high - error)) return Crossing::doubtful;
  if (rate > 0.0) normal = -normal;
  hit.t = t;
  Vector3d::Map(hit.normal) = normal;
  return Crossing::found;
}

bool comes_from_behind(const SurfaceRay& ray, const double (&corner)[3][3]) noexcept {
  const Vector3d at = Vector3d::Map(corner[0]);
  const Vector3d normal = (Vector3d::Map(corner[1]) - at).cross(Vector3d::Map(corner[2]) - at);
  return normal.dot(Vector3d::Map(ray.direction)) > 0.0;
}

void mesh_rays(const MeshView& mesh, const SurfaceRays& rays, const double* limits,
               std::uint32_t count, const RaySlotVisitor& visitor) noexcept {
  if (mesh.triangle_count == 0 || count == 0) return;
  mesh_kernels().rays(mesh, rays, limits, count, visitor);
}

void mesh_ray(const MeshView& mesh, const LoneSurfaceRay& ray, double limit,
              const RaySlotVisitor& visitor) noexcept {
  if (mesh.triangle_count != 0) mesh_kernels().ray(mesh, ray, limit, visitor);
}

}  // namespace winnow
