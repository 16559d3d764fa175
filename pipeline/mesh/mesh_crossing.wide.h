#pragma once

// Where a ray meets a triangle, by the signs of the volumes between it and the sides (Platis,
// Theoharis, "Fast ray-tetrahedron intersection using Pluecker coordinates", 2003). In double,
// without fused operations that some instruction sets do not have: the same on all.

#include "pipeline/mesh/mesh_ray_setup.wide.h"
#include "pipeline/mesh/mesh_view.h"
#include "pipeline/mesh/surface_rays.h"
#include "pipeline/shapes/difference_of_products.h"
#include "simd/lanes/corners.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// A triangle twice: by axis in lanes, and corner by corner.
struct CrossedTriangle {
  CornerDoubles by_axis[3];
  Numbers corner[3];
};

[[gnu::always_inline]] inline CrossedTriangle load_triangle(const MeshView& mesh,
                                                            std::uint32_t slot) {
  CrossedTriangle triangle;
  const float* at[3];
  for (int k = 0; k < 3; ++k) {
    at[k] = mesh.vertex + std::size_t{3} * corner_of(mesh, static_cast<std::size_t>(k), slot);
    triangle.corner[k] = {static_cast<double>(at[k][0]), static_cast<double>(at[k][1]),
                          static_cast<double>(at[k][2])};
  }
  load_points(at[0], at[1], at[2], triangle.by_axis);
  return triangle;
}
[[gnu::always_inline]] inline CrossedTriangle load_triangle(const double (&corner)[3][3]) {
  CrossedTriangle triangle;
  for (int k = 0; k < 3; ++k) triangle.corner[k] = {corner[k][0], corner[k][1], corner[k][2]};
  for (int axis = 0; axis < 3; ++axis) {
    triangle.by_axis[axis] = join_corners(corner[0][axis], corner[1][axis], corner[2][axis]);
  }
  return triangle;
}

[[gnu::always_inline]] inline double taxicab(const Numbers& v) {
  return abs(v.x) + abs(v.y) + abs(v.z);
}
[[gnu::always_inline]] inline double dot(const Numbers& a, const Numbers& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The product of two edges of a triangle, at right angles to both. Where no more than three bits
/// of the products cancel, they need no more care.
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

/// The first lane.
[[gnu::always_inline]] inline double first_of(const CornerDoubles& v) {
  alignas(64) double lane[CornerDoubles::kCount];
  v.store(lane);
  return lane[0];
}

/// A ray as each of three numbers, and by itself.
struct CrossingRay {
  Vec3<double, CornerDoubles::kParts> origin;
  Vec3<double, CornerDoubles::kParts> direction;
  Numbers start;
  Numbers way;
  double slack;
  double low;
  double high;
};

/// See cross_triangle.
[[gnu::always_inline]] inline Crossing cross(const CrossingRay& ray,
                                             const CrossedTriangle& triangle, SurfaceHit& hit) {
  using D = CornerDoubles;
  using V = Vec3<double, D::kParts>;
  const auto& corner = triangle.by_axis;
  const V from = V{corner[0], corner[1], corner[2]} - ray.origin;
  const V next{of_next(from.x), of_next(from.y), of_next(from.z)};
  const D length = taxicab(from);
  const D after = of_next(length);
  const D far = length + after + of_next(after);
  const D doubt = taxicab(ray.direction) * far * (D(0x1p-48) * far + D(4.0 * ray.slack));
  const D volume = dot(winnow::WINNOW_ISA_NAME::cross(from, ray.direction), next);
  const Mask16 above = bits(volume > doubt) & kThreeCorners;
  const Mask16 below = bits(volume < -doubt) & kThreeCorners;
  if (above != 0 && below != 0) return Crossing::none;
  if (above != kThreeCorners && below != kThreeCorners) return Crossing::doubtful;
  const Numbers& first = triangle.corner[0];
  const Numbers normal = normal_of(triangle.corner[1] - first, triangle.corner[2] - first);
  const double rate = dot(normal, ray.way);
  const double t = dot(normal, first - ray.start) / rate;
  const double error = taxicab(normal) * (2.0 * ray.slack + 0x1p-48 * first_of(far)) / abs(rate);
  if (t < ray.low - error || t > ray.high + error) return Crossing::none;
  if (!(t > ray.low + error && t < ray.high - error)) return Crossing::doubtful;
  hit.t = t;
  const double side = rate > 0.0 ? -1.0 : 1.0;
  hit.normal[0] = side * normal.x;
  hit.normal[1] = side * normal.y;
  hit.normal[2] = side * normal.z;
  return Crossing::found;
}

template <std::uint32_t Room>
[[gnu::always_inline]] inline CrossingRay crossing_ray(const SurfaceRayColumns<Room>& rays,
                                                       std::uint32_t ray) {
  const auto& start = rays.ray.origin;
  const auto& way = rays.ray.direction;
  return {{start[0][ray], start[1][ray], start[2][ray]},
          {way[0][ray], way[1][ray], way[2][ray]},
          {start[0][ray], start[1][ray], start[2][ray]},
          {way[0][ray], way[1][ray], way[2][ray]},
          rays.slack[ray],
          rays.low[ray],
          rays.high[ray]};
}

/// Of a triangle that is in no mesh.
inline Crossing cross_triangle(const SurfaceRay& ray, const double (&corner)[3][3],
                               SurfaceHit& hit) {
  const double* const start = ray.origin;
  const double* const way = ray.direction;
  const CrossingRay crossing{{start[0], start[1], start[2]},
                             {way[0], way[1], way[2]},
                             {start[0], start[1], start[2]},
                             {way[0], way[1], way[2]},
                             ray.slack,
                             ray.low,
                             ray.high};
  return cross(crossing, load_triangle(corner), hit);
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
