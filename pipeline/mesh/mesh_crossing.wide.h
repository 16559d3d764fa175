#pragma once

// Ray-triangle intersection by the signs of the volumes between the ray and the sides (Platis,
// Theoharis, "Fast ray-tetrahedron intersection using Pluecker coordinates", 2003). Computed in
// double, without fused operations, which some instruction sets lack, so that results are equal on
// all of them.

#include "pipeline/mesh/mesh_ray_setup.wide.h"
#include "pipeline/mesh/mesh_view.h"
#include "pipeline/mesh/surface_rays.h"
#include "pipeline/shapes/difference_of_products.h"
#include "simd/lanes/corners.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

[[gnu::always_inline]] inline double taxicab(const Numbers& v) {
  return abs(v.x) + abs(v.y) + abs(v.z);
}
[[gnu::always_inline]] inline double dot(const Numbers& a, const Numbers& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Cross product of two edges of a triangle. If cancellation removes at most three bits, plain
/// products are accurate enough; else difference_of_products is used.
[[gnu::always_inline]] inline Numbers normal_of(const Numbers& a, const Numbers& b) {
  const Numbers plus{a.y * b.z, a.z * b.x, a.x * b.y};
  const Numbers minus{a.z * b.y, a.x * b.z, a.y * b.x};
  const Numbers normal = plus - minus;
  constexpr double kLeastLeft = 0.125;
  if (taxicab(normal) > kLeastLeft * (taxicab(plus) + taxicab(minus))) [[likely]]
    return normal;
  return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
          difference_of_products(a.x, b.y, a.y, b.x)};
}

/// Tests whether the line of a ray passes all sides of a triangle on one side. The corners are
/// given by axis.
[[gnu::always_inline]] inline Crossing cross_sides(const SurfaceRay& ray,
                                                   const CornerDoubles (&corner)[3]) {
  using D = CornerDoubles;
  using V = Vec3<double, D::kParts>;
  const V origin{ray.origin[0], ray.origin[1], ray.origin[2]};
  const V direction{ray.direction[0], ray.direction[1], ray.direction[2]};
  const V from = V{corner[0], corner[1], corner[2]} - origin;
  const V next{of_next(from.x), of_next(from.y), of_next(from.z)};
  const D length = taxicab(from);
  const D after = of_next(length);
  const D far = length + after + of_next(after);
  const D doubt = taxicab(direction) * far * (D(0x1p-48) * far + D(4.0 * ray.slack));
  const D volume = dot(winnow::WINNOW_ISA_NAME::cross(from, direction), next);
  const Mask16 above = bits(volume > doubt) & kThreeCorners;
  const Mask16 below = bits(volume < -doubt) & kThreeCorners;
  if (above != 0 && below != 0) return Crossing::none;
  return above == kThreeCorners || below == kThreeCorners ? Crossing::found : Crossing::doubtful;
}

/// Given that the ray's line crosses the triangle, tests whether it does so within [ray.low,
/// ray.high].
[[gnu::always_inline]] inline Crossing cross_plane(const SurfaceRay& ray,
                                                   const Numbers (&corner)[3], SurfaceHit& hit) {
  const Numbers start{ray.origin[0], ray.origin[1], ray.origin[2]};
  const Numbers way{ray.direction[0], ray.direction[1], ray.direction[2]};
  const Numbers from = corner[0] - start;
  const Numbers a = corner[1] - corner[0];
  const Numbers b = corner[2] - corner[0];
  const Numbers normal = normal_of(a, b);
  const double rate = dot(normal, way);
  const double t = dot(normal, from) / rate;
  // Upper bound on the distances of all corners from the ray's origin.
  const double far = 3.0 * taxicab(from) + taxicab(a) + taxicab(b);
  const double error = taxicab(normal) * (2.0 * ray.slack + 0x1p-48 * far) / abs(rate);
  if (t < ray.low - error || t > ray.high + error) return Crossing::none;
  if (!(t > ray.low + error && t < ray.high - error)) return Crossing::doubtful;
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
  Numbers corner[3];
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
  Numbers corners[3];
  for (int k = 0; k < 3; ++k) {
    by_axis[k] = join_corners(corner[0][k], corner[1][k], corner[2][k]);
    corners[k] = {corner[k][0], corner[k][1], corner[k][2]};
  }
  const Crossing sides = cross_sides(ray, by_axis);
  return sides == Crossing::found ? cross_plane(ray, corners, hit) : sides;
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
