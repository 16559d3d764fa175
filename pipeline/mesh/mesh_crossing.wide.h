#pragma once

// Where a ray meets a triangle, by the signs of the volumes between it and the sides (Platis,
// Theoharis, "Fast ray-tetrahedron intersection using Pluecker coordinates", 2003). In double,
// without fused operations that some instruction sets do not have: the same on all.

#include "pipeline/mesh/mesh_ray_setup.wide.h"
#include "pipeline/mesh/mesh_view.h"
#include "pipeline/mesh/surface_rays.h"
#include "pipeline/shapes/difference_of_products.h"
#include "simd/lanes/axes.h"
#include "simd/lanes/corners.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// A triangle twice: by axis, and corner by corner.
struct TriangleInLanes {
  CornerDoubles by_axis[3];
  Axes corner[3];
};

[[gnu::always_inline]] inline TriangleInLanes load_triangle(const MeshView& mesh,
                                                            std::uint32_t slot) {
  TriangleInLanes triangle;
  const float* at[3];
  for (int k = 0; k < 3; ++k) {
    at[k] = mesh.vertex + std::size_t{3} * corner_of(mesh, static_cast<std::size_t>(k), slot);
    triangle.corner[k] = load_axes(at[k]);
  }
  load_points(at[0], at[1], at[2], triangle.by_axis);
  return triangle;
}
[[gnu::always_inline]] inline TriangleInLanes load_triangle(const double (&corner)[3][3]) {
  TriangleInLanes triangle;
  for (int k = 0; k < 3; ++k) {
    triangle.corner[k] = join_axes(corner[k][0], corner[k][1], corner[k][2]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    triangle.by_axis[axis] = join_corners(corner[0][axis], corner[1][axis], corner[2][axis]);
  }
  return triangle;
}

[[gnu::always_inline]] inline double sum_of(const Components& c) {
  return c.of[0] + c.of[1] + c.of[2];
}
[[gnu::always_inline]] inline double taxicab(const Axes& v) {
  return sum_of(Components(abs(v)));
}

/// The product of two edges of a triangle, at right angles to both. Where no more than three bits
/// of the products cancel, they need no more care.
[[gnu::always_inline]] inline Axes normal_of(const Axes& a, const Axes& b) {
  const Axes a_next = of_next(a);
  const Axes b_next = of_next(b);
  const Axes plus = a_next * of_next(b_next);
  const Axes minus = of_next(a_next) * b_next;
  const Axes normal = plus - minus;
  constexpr double kLeastLeft = 0.125;
  if (taxicab(normal) > kLeastLeft * (taxicab(plus) + taxicab(minus))) [[likely]]
    return normal;
  const Components p(a);
  const Components q(b);
  return join_axes(difference_of_products(p.of[1], q.of[2], p.of[2], q.of[1]),
                   difference_of_products(p.of[2], q.of[0], p.of[0], q.of[2]),
                   difference_of_products(p.of[0], q.of[1], p.of[1], q.of[0]));
}

/// A ray as each of three numbers, and by itself.
struct CrossingRay {
  Vec3<double, CornerDoubles::kParts> origin;
  Vec3<double, CornerDoubles::kParts> direction;
  Axes start;
  Axes way;
  double slack;
  double low;
  double high;
};

/// See cross_triangle.
[[gnu::always_inline]] inline Crossing cross(const CrossingRay& ray,
                                             const TriangleInLanes& triangle, SurfaceHit& hit) {
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
  const Axes& first = triangle.corner[0];
  const Axes normal = normal_of(triangle.corner[1] - first, triangle.corner[2] - first);
  const double rate = dot(normal, ray.way);
  const double t = dot(normal, first - ray.start) / rate;
  const double error =
      taxicab(normal) * (2.0 * ray.slack + 0x1p-48 * Components(far).of[0]) / __builtin_fabs(rate);
  if (t < ray.low - error || t > ray.high + error) return Crossing::none;
  if (!(t > ray.low + error && t < ray.high - error)) return Crossing::doubtful;
  hit.t = t;
  const Components towards(rate > 0.0 ? -normal : normal);
  for (int axis = 0; axis < 3; ++axis) hit.normal[axis] = towards.of[axis];
  return Crossing::found;
}

template <std::uint32_t Room>
[[gnu::always_inline]] inline CrossingRay crossing_ray(const SurfaceRayColumns<Room>& rays,
                                                       std::uint32_t ray) {
  const auto& start = rays.ray.origin;
  const auto& way = rays.ray.direction;
  return {{start[0][ray], start[1][ray], start[2][ray]},
          {way[0][ray], way[1][ray], way[2][ray]},
          join_axes(start[0][ray], start[1][ray], start[2][ray]),
          join_axes(way[0][ray], way[1][ray], way[2][ray]),
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
                             join_axes(start[0], start[1], start[2]),
                             join_axes(way[0], way[1], way[2]),
                             ray.slack,
                             ray.low,
                             ray.high};
  return cross(crossing, load_triangle(corner), hit);
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
