#pragma once

// Tests sixteen triangles of a mesh against a hull. The first test uses one direction per triangle,
// from the triangle's point closest to the hull's centre to this centre (Ericson, "Real-Time
// Collision Detection", 2005, 5.1.5), against all vertices of the hull. The remaining triangles are
// tested against the hull's face planes, sixteen planes at a time. Directions need not be exact: if
// the triangle and the hull are apart along any direction, they are disjoint. Heights along a
// direction are accurate to a few roundings. Called by mesh_overlaps.wide.h.

#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_traversal.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// Corners in the hull's frame, relative to the hull's centre, scaled so that the hull's radius is
/// about 1.
struct HullCorners {
  /// Products of numbers of this size stay in the range of float.
  static constexpr float kLargestCorner = 1e6F;

  Vec3<float> at[3];
  Floats reach;  ///< a triangle beyond the hull by more than this is certainly outside

  HullCorners(const Corners16& corners, const MeshHullJob& hull) {
    Floats sum(0.0F);
    for (int k = 0; k < 3; ++k) {
      Floats from[3];
      for (int axis = 0; axis < 3; ++axis) {
        from[axis] = corners.at[k][axis] - Floats(hull.middle[axis]);
      }
      const auto row = [&](int i) {
        const float* const m = hull.matrix[i];
        return Floats(m[0]) * from[0] + Floats(m[1]) * from[1] + Floats(m[2]) * from[2] +
               Floats(hull.offset[i]);
      };
      at[k] = {row(0), row(1), row(2)};
      sum += norm_l1(at[k]);
    }
    // Corners and heights accumulate about forty roundings of numbers no larger than these.
    reach = Floats(hull.reach) + (sum + Floats(hull.largest)) * Floats(0x1p-18F);
    is_small_ = sum < Floats(kLargestCorner);
  }

  [[nodiscard]] Mask16 are_small() const { return bits(is_small_); }

 private:
  /// False for lanes with NaN.
  LaneMask<float> is_small_;
};

/// From the closest point of each triangle to the origin, towards the origin; of any length.
[[gnu::always_inline]] inline Vec3<float> way_to_origin(const Vec3<float> (&corner)[3]) {
  const Floats zero(0.0F);
  const Vec3<float> a = -corner[0];
  const Vec3<float> ab = corner[1] - corner[0];
  const Vec3<float> ac = corner[2] - corner[0];
  const Floats along_ab[3] = {dot(ab, a), -dot(ab, corner[1]), -dot(ab, corner[2])};
  const Floats along_ac[3] = {dot(ac, a), -dot(ac, corner[1]), -dot(ac, corner[2])};
  const Vec3<float> normal = cross(ab, ac);
  Vec3<float> way = select(dot(normal, a) < zero, -normal, normal);
  const auto take = [&](const LaneMask<float>& where, const Vec3<float>& other) {
    way = select(where, other, way);
  };
  const Floats past_b = along_ac[1] - along_ab[1];
  const Floats past_c = along_ab[2] - along_ac[2];
  const Floats over_bc = along_ab[1] * along_ac[2] - along_ab[2] * along_ac[1];
  take((over_bc <= zero) & (past_b >= zero) & (past_c >= zero),
       (-corner[1]) * (past_b + past_c) - (ac - ab) * past_b);
  const Floats over_ac = along_ab[2] * along_ac[0] - along_ab[0] * along_ac[2];
  take((over_ac <= zero) & (along_ac[0] >= zero) & (along_ac[2] <= zero),
       a * (along_ac[0] - along_ac[2]) - ac * along_ac[0]);
  const Floats over_ab = along_ab[0] * along_ac[1] - along_ab[1] * along_ac[0];
  take((over_ab <= zero) & (along_ab[0] >= zero) & (along_ab[1] <= zero),
       a * (along_ab[0] - along_ab[1]) - ab * along_ab[0]);
  take((along_ac[2] >= zero) & (along_ab[2] <= along_ac[2]), -corner[2]);
  take((along_ab[1] >= zero) & (along_ac[1] <= along_ab[1]), -corner[1]);
  take((along_ab[0] <= zero) & (along_ac[0] <= zero), a);
  return way;
}

/// The triangles that are below all of the hull along `way` by more than their reach.
[[gnu::always_inline]] inline Mask16 below_vertices(const HullCorners& t, const Vec3<float>& way,
                                                    const MeshHullJob& hull) {
  const HullShape& shape = *hull.shape;
  const auto vertex = [&](int axis, std::uint32_t i) {
    return Floats((shape.vertex_float[axis][i] - hull.center[axis]) * hull.scale);
  };
  Floats low(__builtin_inff());
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
    low = min(low, way.x * vertex(0, i) + way.y * vertex(1, i) + way.z * vertex(2, i));
  }
  const Floats top = max(max(dot(way, t.at[0]), dot(way, t.at[1])), dot(way, t.at[2]));
  const Floats gap = low - top;
  const Floats reach = t.reach * Floats(1.0F + 0x1p-20F);
  return bits((gap > Floats(0.0F)) & (gap * gap > dot(way, way) * (reach * reach)));
}

/// Returns whether one triangle is beyond one of the hull's faces.
inline bool beyond_face(const float (&corner)[3][3], float reach, const MeshHullJob& hull) {
  const float* const* const plane = hull.shape->plane_float;
  const Floats least_height(reach);
  for (std::uint32_t row = 0; row < hull.shape->face_count; row += kLanes) {
    const Vec3<float> n{Floats::load(plane[0] + row), Floats::load(plane[1] + row),
                        Floats::load(plane[2] + row)};
    const auto height = [&](const float* x) { return dot(n, Vec3<float>{x[0], x[1], x[2]}); };
    const Floats base = (height(hull.center) - Floats::load(plane[3] + row)) * Floats(hull.scale);
    const Floats least = min(min(height(corner[0]), height(corner[1])), height(corner[2]));
    const std::uint32_t left = hull.shape->face_count - row;
    const Mask16 there = lanes_below(left < kLanes ? left : kLanes);
    if ((bits(base + least > least_height) & there) != 0) return true;
  }
  return false;
}

/// The triangles that are certainly outside the hull; NaN never counts as outside.
inline Mask16 outside_hull(const Corners16& corners, Mask16 lanes, const MeshHullJob& hull) {
  const HullCorners t(corners, hull);
  Mask16 out = below_vertices(t, way_to_origin(t.at), hull) & t.are_small();
  alignas(64) float at[3][3][kLanes];
  alignas(64) float reach[kLanes];
  for (int k = 0; k < 3; ++k) {
    t.at[k].x.store(at[k][0]);
    t.at[k].y.store(at[k][1]);
    t.at[k].z.store(at[k][2]);
  }
  t.reach.store(reach);
  for (Mask16 rest = lanes & t.are_small() & ~out; rest != 0; rest &= rest - 1) {
    const unsigned lane = first(rest);
    float corner[3][3];
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) corner[k][axis] = at[k][axis][lane];
    }
    if (beyond_face(corner, reach[lane], hull)) out |= 1U << lane;
  }
  return out;
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
