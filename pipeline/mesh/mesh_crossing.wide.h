#pragma once

// Ray-triangle intersection by the signs of the volumes between the ray and the sides (Platis,
// Theoharis, "Fast ray-tetrahedron intersection using Pluecker coordinates", 2003). The computation
// is in double. It uses no fused operations, because some instruction sets lack these and results
// must be equal on all instruction sets.

#include "pipeline/mesh/mesh_ray_setup.wide.h"
#include "pipeline/mesh/mesh_view.h"
#include "pipeline/mesh/surface_rays.h"
#include "pipeline/shapes/difference_of_products.h"
#include "simd/lanes/triangle_lanes.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

[[gnu::always_inline]] inline double norm_l1(const ScalarVec3& v) {
  return abs(v.x) + abs(v.y) + abs(v.z);
}
[[gnu::always_inline]] inline double dot(const ScalarVec3& a, const ScalarVec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Cross product of two edges of a triangle. If cancellation removes at most three bits, plain
/// products are accurate enough; else difference_of_products is used.
[[gnu::always_inline]] inline ScalarVec3 normal_of(const ScalarVec3& a, const ScalarVec3& b) {
  const ScalarVec3 plus{a.y * b.z, a.z * b.x, a.x * b.y};
  const ScalarVec3 minus{a.z * b.y, a.x * b.z, a.y * b.x};
  const ScalarVec3 normal = plus - minus;
  constexpr double kMinLeft = 0.125;
  if (norm_l1(normal) > kMinLeft * (norm_l1(plus) + norm_l1(minus))) [[likely]]
    return normal;
  return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
          difference_of_products(a.x, b.y, a.y, b.x)};
}

/// Tests whether the line of a ray passes all sides of a triangle on the same side. The corners are
/// given by axis.
[[gnu::always_inline]] inline Crossing cross_sides(const SurfaceRay& ray,
                                                   const CornerDoubles (&corner)[3]) {
  using D = CornerDoubles;
  using V = Vec3<double, D::kParts>;
  const V origin{ray.origin[0], ray.origin[1], ray.origin[2]};
  const V direction{ray.direction[0], ray.direction[1], ray.direction[2]};
  const V from = V{corner[0], corner[1], corner[2]} - origin;
  const V next{of_next(from.x), of_next(from.y), of_next(from.z)};
  const D length = norm_l1(from);
  const D after = of_next(length);
  const D far = length + after + of_next(after);
  const D error_bound = norm_l1(direction) * far * (D(0x1p-48) * far + D(4.0 * ray.slack));
  const D volume = dot(winnow::WINNOW_ISA_NAME::cross(from, direction), next);
  const Mask16 above = bits(volume > error_bound) & kThreeCorners;
  const Mask16 below = bits(volume < -error_bound) & kThreeCorners;
  if (above != 0 && below != 0) return Crossing::none;
  return above == kThreeCorners || below == kThreeCorners ? Crossing::found : Crossing::uncertain;
}

/// Given that the ray's line crosses the triangle, tests whether it does so within [ray.low,
/// ray.high].
[[gnu::always_inline]] inline Crossing cross_plane(const SurfaceRay& ray,
                                                   const ScalarVec3 (&corner)[3], SurfaceHit& hit) {
  const ScalarVec3 start{ray.origin[0], ray.origin[1], ray.origin[2]};
  const ScalarVec3 way{ray.direction[0], ray.direction[1], ray.direction[2]};
  const ScalarVec3 from = corner[0] - start;
  const ScalarVec3 a = corner[1] - corner[0];
  const ScalarVec3 b = corner[2] - corner[0];
  const ScalarVec3 normal = normal_of(a, b);
  const double rate = dot(normal, way);
  const double t = dot(normal, from) / rate;
  // Upper bound on the distances of all corners from the ray's origin.
  const double far = 3.0 * norm_l1(from) + norm_l1(a) + norm_l1(b);
  const double error = norm_l1(normal) * (2.0 * ray.slack + 0x1p-48 * far) / abs(rate);
  if (t < ray.low - error || t > ray.high + error) return Crossing::none;
  if (!(t > ray.low + error && t < ray.high - error)) return Crossing::uncertain;
  hit.t = t;
  const double side = rate > 0.0 ? -1.0 : 1.0;
  hit.normal[0] = side * normal.x;
  hit.normal[1] = side * normal.y;
  hit.normal[2] = side * normal.z;
  return Crossing::found;
}

/// cross_triangle for a triangle of a mesh. `is_sure`: the ray's line certainly crosses the
/// triangle.
[[gnu::always_inline]] inline Crossing cross_slot(const SurfaceRay& ray, const MeshView& mesh,
                                                  std::uint32_t slot, bool is_sure,
                                                  SurfaceHit& hit) {
  ScalarVec3 corner[3];
  const float* at[3];
  for (std::size_t k = 0; k < 3; ++k) {
    at[k] = mesh.vertex + std::size_t{3} * corner_of(mesh, k, slot);
    corner[k] = {static_cast<double>(at[k][0]), static_cast<double>(at[k][1]),
                 static_cast<double>(at[k][2])};
  }
  if (!is_sure) {
    CornerDoubles by_axis[3];
    load_points(at[0], at[1], at[2], by_axis);
    const Crossing sides = cross_sides(ray, by_axis);
    if (sides != Crossing::found) return sides;
  }
  return cross_plane(ray, corner, hit);
}

/// cross_triangle for a triangle that is not in a mesh.
inline Crossing cross_triangle(const SurfaceRay& ray, const double (&corner)[3][3],
                               SurfaceHit& hit) {
  CornerDoubles by_axis[3];
  ScalarVec3 corners[3];
  for (int k = 0; k < 3; ++k) {
    by_axis[k] = join_corners(corner[0][k], corner[1][k], corner[2][k]);
    corners[k] = {corner[k][0], corner[k][1], corner[k][2]};
  }
  const Crossing sides = cross_sides(ray, by_axis);
  return sides == Crossing::found ? cross_plane(ray, corners, hit) : sides;
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
