#pragma once

// Ray-triangle tests. A float test of sixteen triangles keeps those for which rounding makes the
// result uncertain; then each is tested in double.
//
// Float: triangles are tested in a frame sheared along the ray, so that the ray becomes an axis, by
// the signs of the areas between the ray and the triangle's sides (Woop, Benthin, Wald, "Watertight
// ray/triangle intersection", JCGT 2013). Coordinates are in node units; if the mesh stores
// quantised vertices (MeshView::leaf_point, four bytes each), these are used. u is half an ulp
// of 1.
//
// Double: by the signs of the volumes between the ray and the sides (Platis, Theoharis, "Fast
// ray-tetrahedron intersection using Pluecker coordinates", 2003). No fused operations, because
// some instruction sets lack these and results must be equal on all instruction sets.

#include "pipeline/mesh/mesh_ray_setup.wide.h"
#include "pipeline/shapes/difference_of_products.h"
#include "simd/lanes/packed_points.h"
#include "simd/lanes/triangle_lanes.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// Corners of triangles in the sheared frame: their coordinates relative to the ray on the two axes
/// other than the ray's fastest axis.
struct CornersAcross {
  Floats x[3];
  Floats y[3];
};

/// The triangles of a leaf that the line of a ray may cross, and a subset that it certainly
/// crosses.
struct LineTriangles {
  Mask16 may;
  Mask16 sure;
};

/// Tests which of sixteen triangles the line of the ray crosses. The error of coordinates is less
/// than `wrong`, which includes 0.05 units for the rounding of products, 6 u of a coordinate of
/// 2^17. A crossing is certain if the areas exceed their error by `surely`.
///
/// The product of two coordinates has an error of less than `wrong` times the sum of their
/// magnitudes, plus twice the square of `wrong`.
[[gnu::always_inline]] inline LineTriangles around_line(const CornersAcross& at, float wrong,
                                                        float surely) {
  const auto norm_l1 = [&](int k) { return abs(at.x[k]) + abs(at.y[k]); };
  const Floats error_bound = multiply_add(norm_l1(0) + norm_l1(1) + norm_l1(2), Floats(wrong),
                                          Floats(2.1F * wrong * wrong));
  const Floats a = at.x[2] * at.y[1] - at.y[2] * at.x[1];
  const Floats b = at.x[0] * at.y[2] - at.y[0] * at.x[2];
  const Floats c = at.x[1] * at.y[0] - at.y[1] * at.x[0];
  const Floats most = max(max(a, b), c);
  const Floats least = min(min(a, b), c);
  const Floats beyond = error_bound + Floats(surely);
  const LaneMask<float> misses = (most > error_bound) & (least < -error_bound);
  const LaneMask<float> sure = (least > beyond) | (most < -beyond);
  return {~bits(misses) & 0xFFFFU, bits(sure)};
}

/// The line of a ray, in node units.
class RayLine {
 public:
  template <std::uint32_t Room>
  [[gnu::always_inline]] void set(const ReadyRays<Room>& rays, std::uint32_t ray) {
    constexpr std::uint32_t kNext[3] = {1, 2, 0};
    const auto size = [&](std::uint32_t axis) { return __builtin_fabsf(rays.inverse[axis][ray]); };
    const std::uint32_t faster = size(1) < size(0) ? 1 : 0;
    fastest_ = size(2) < size(faster) ? 2 : faster;
    side_[0] = kNext[fastest_];
    side_[1] = kNext[side_[0]];
    const float along = rays.inverse[fastest_][ray];
    float wrong[2];
    for (std::uint32_t k = 0; k < 2; ++k) {
      const std::uint32_t axis = side_[k];
      const float slope = -along / rays.inverse[axis][ray];
      slope_[k] = slope;
      at_[k] = rays.at[axis][ray] + slope * rays.at[fastest_][ray];
      wrong[k] = rays.grow[axis][ray] + __builtin_fabsf(slope) * rays.grow[fastest_][ray];
    }
    wrong_ = larger(wrong[0], wrong[1]) + kRoundings;
    surely_ = rays.surely[ray] * __builtin_fabsf(along);
  }

  /// The triangles of a leaf that the line may cross.
  [[gnu::always_inline]] LineTriangles near(const MeshView& mesh, std::uint32_t leaf) const {
    const int blocks = mesh.leaf_point != nullptr ? vertex_blocks(mesh, leaf) : 0;
    if (blocks == 1) return near_listed<1>(mesh, leaf);
    if (blocks == 2) return near_listed<2>(mesh, leaf);
    return near_corners(mesh, leaf);
  }

 private:
  /// Covers the rounding of coordinates computed in this class, up to 65536 units, and of their
  /// products.
  static constexpr float kRoundings = 0.12F;

  [[gnu::always_inline]] static float larger(float a, float b) { return a > b ? a : b; }

  /// Uses the quantised vertices that the leaf lists, each with an error of half a step.
  template <int Blocks>
  [[gnu::always_inline]] LineTriangles near_listed(const MeshView& mesh, std::uint32_t leaf) const {
    constexpr float kShare = 1.0F / kMaxLeafPoint;
    const std::uint16_t* const bounds = mesh.node[0] + place_of_bound(leaf, 0);
    const auto low = [&](std::uint32_t axis) { return static_cast<float>(bounds[axis * kLanes]); };
    const auto extent = [&](std::uint32_t axis) {
      return static_cast<float>(bounds[(3 + axis) * kLanes] - bounds[axis * kLanes]);
    };
    const float low_along = low(fastest_);
    const float extent_along = extent(fastest_);
    float from[2];
    float step[2];
    float tilt[2];
    float steps[2];
    for (int k = 0; k < 2; ++k) {
      from[k] = (low(side_[k]) - at_[k]) + slope_[k] * low_along;
      step[k] = extent(side_[k]) * kShare;
      tilt[k] = extent_along * (slope_[k] * kShare);
      steps[k] = step[k] + __builtin_fabsf(tilt[k]);
    }
    Floats x[Blocks];
    Floats y[Blocks];
    for (int block = 0; block < Blocks; ++block) {
      const std::uint32_t* const points =
          mesh.leaf_point + block_of(mesh, leaf, block) * kMeshFanout;
      const Floats along = load_packed(points, fastest_);
      x[block] = multiply_add(load_packed(points, side_[0]), Floats(step[0]),
                              multiply_add(along, Floats(tilt[0]), Floats(from[0])));
      y[block] = multiply_add(load_packed(points, side_[1]), Floats(step[1]),
                              multiply_add(along, Floats(tilt[1]), Floats(from[1])));
    }
    CornersAcross at;
    for (std::size_t k = 0; k < 3; ++k) {
      const LanePermutation places(places_of(mesh, leaf, k));
      at.x[k] = places.pick(x);
      at.y[k] = places.pick(y);
    }
    return around_line(at, wrong_ + 0.51F * larger(steps[0], steps[1]), surely_);
  }

  /// Uses each corner's vertex.
  [[gnu::always_inline]] LineTriangles near_corners(const MeshView& mesh,
                                                    std::uint32_t leaf) const {
    CornersAcross at;
    for (std::size_t k = 0; k < 3; ++k) {
      Floats corner[3];
      load_corners(mesh, leaf, k, corner);
      for (int axis = 0; axis < 3; ++axis) {
        corner[axis] =
            (corner[axis] - Floats(mesh.origin[axis])) * Floats(mesh.span.float_units[axis]);
      }
      const Floats along = corner[fastest_];
      at.x[k] = multiply_add(along, Floats(slope_[0]), corner[side_[0]] - Floats(at_[0]));
      at.y[k] = multiply_add(along, Floats(slope_[1]), corner[side_[1]] - Floats(at_[1]));
    }
    return around_line(at, wrong_, surely_);
  }

  /// The fastest axis, and the other two.
  std::uint32_t fastest_;
  std::uint32_t side_[2];
  /// Shear: the change of the other two coordinates per unit along the fastest axis, and the
  /// sheared position of the ray.
  float slope_[2];
  float at_[2];
  float wrong_;
  /// See ReadyRays::surely.
  float surely_;
};

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
  hit.from_behind = rate > 0.0;
  const double side = hit.from_behind ? -1.0 : 1.0;
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
