#pragma once

// Sixteen triangles of one mesh against one of another, in the scaled frame of the first: boxes,
// then the planes of both as separating ones. A pair is dropped only where it is apart by more than
// rounding can have added; u is half an ulp of 1. A number that is not finite drops nothing.

#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_traversals.kernel.h"

namespace winnow::WINNOW_ISA_NAME {

inline constexpr float kUlp = 0x1p-24F;
// More than what underflows of any product here.
inline constexpr float kTiny = 0x1p-110F;

/// Triangles of a leaf of a. What their planes take is found when first asked for.
struct PairLeaf {
  Corners16 corners;
  Box16 box;
  Mask16 lanes;
  bool has_planes;
  Single16 normal[3];
  /// Sum of the absolute values of the two products whose difference `normal` is.
  Single16 size[3];
  /// Rounding of distances from the plane that is due to the extent of the triangle itself.
  Single16 doubt;
};

/// Triangles of a leaf of b, one by one to be broadcast; their planes too when first asked for.
struct PlacedTriangles {
  Mask16 lanes;
  bool has_planes;
  alignas(64) float corner[3][3][kLanes];
  /// The largest absolute value of a coordinate.
  alignas(64) float largest[3][kLanes];
  /// Grown by slack and rounding.
  alignas(64) float low[3][kLanes];
  alignas(64) float high[3][kLanes];
  /// 32 u of how far a corner of a triangle whose box meets may lie from one of these, and 2 u of
  /// the coordinate: times `size` of the other triangle the rounding of its plane's distances.
  alignas(64) float doubt[3][kLanes];
  alignas(64) float normal[3][kLanes];
  /// Rounding of the normal: times such a distance that of this plane's distances.
  alignas(64) float wobble[3][kLanes];
  /// Extent and slack.
  alignas(64) float reach[3][kLanes];
  /// How far the slack reaches along the normal, with the rounding of the corner it starts from.
  alignas(64) float thickness[kLanes];

  [[nodiscard]] Box16 box() const {
    Box16 r;
    for (int axis = 0; axis < 3; ++axis) {
      r.low[axis] = load(low[axis]);
      r.high[axis] = load(high[axis]);
    }
    return r;
  }
};

/// The two products of each component of the cross product of p and q, subtracted and, by absolute
/// value, added.
[[gnu::always_inline]] inline void cross_sizes(const Single16 (&p)[3], const Single16 (&q)[3],
                                               Single16 (&normal)[3], Single16 (&size)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    const int j = (axis + 1) % 3;
    const int k = (axis + 2) % 3;
    const Single16 plus = p[j] * q[k];
    const Single16 minus = p[k] * q[j];
    normal[axis] = plus - minus;
    size[axis] = abs(plus) + abs(minus);
  }
}

inline void load_leaf(const MeshView& a, const MeshPairJob& job, std::uint32_t leaf,
                      PairLeaf& out) {
  out.corners = load_corners(a, leaf);
  const Single16 scale(job.scale);
  for (auto& corner : out.corners.at) {
    for (auto& x : corner) x *= scale;
  }
  out.box = box_of(out.corners);
  out.lanes = present(a.triangle_count, leaf * kMeshFanout);
  out.has_planes = false;
}

inline void add_planes(PairLeaf& out) {
  out.has_planes = true;
  Single16 first_edge[3];
  Single16 last_edge[3];
  for (int axis = 0; axis < 3; ++axis) {
    first_edge[axis] = out.corners.at[1][axis] - out.corners.at[0][axis];
    last_edge[axis] = out.corners.at[2][axis] - out.corners.at[0][axis];
  }
  cross_sizes(first_edge, last_edge, out.normal, out.size);
  out.doubt = Single16(kTiny);
  for (int axis = 0; axis < 3; ++axis) {
    const Single16 extent = real_of(out.box.high[axis]) - real_of(out.box.low[axis]);
    out.doubt += out.size[axis] * extent * Single16(32.0F * kUlp);
  }
}

/// The corners of b's leaf in double, brought into the scaled frame of a and rounded.
inline Corners16 place_corners(const MeshView& b, const MeshPairJob& job, std::uint32_t leaf) {
  const Corners16 own = load_corners(b, leaf);
  const Double8 scale(static_cast<double>(job.scale));
  Corners16 placed;
  for (int k = 0; k < 3; ++k) {
    Double8 low[3];
    Double8 high[3];
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = to_double<0>(own.at[k][axis]);
      high[axis] = to_double<1>(own.at[k][axis]);
    }
    for (int row = 0; row < 3; ++row) {
      Double8 x(job.offset[row]);
      Double8 y(job.offset[row]);
      for (int axis = 0; axis < 3; ++axis) {
        const Double8 m(job.matrix[row][axis]);
        x += m * low[axis];
        y += m * high[axis];
      }
      placed.at[k][row] = to_single(x * scale, y * scale);
    }
  }
  return placed;
}

inline void add_planes(const MeshPairJob& job, PlacedTriangles& out) {
  out.has_planes = true;
  Single16 first_edge[3];
  Single16 last_edge[3];
  Single16 longest[3];
  Single16 largest[3];
  for (int axis = 0; axis < 3; ++axis) {
    const Single16 origin = Single16::load(out.corner[0][axis]);
    first_edge[axis] = Single16::load(out.corner[1][axis]) - origin;
    last_edge[axis] = Single16::load(out.corner[2][axis]) - origin;
    longest[axis] = max(abs(first_edge[axis]), abs(last_edge[axis]));
    largest[axis] = Single16::load(out.largest[axis]);
  }
  Single16 normal[3];
  Single16 size[3];
  cross_sizes(first_edge, last_edge, normal, size);
  Single16 thickness(kTiny);
  for (int axis = 0; axis < 3; ++axis) {
    const int j = (axis + 1) % 3;
    const int k = (axis + 2) % 3;
    // Edges are wrong by 4 u of the coordinates: each corner was rounded once, the edge once more.
    const Single16 edges = longest[j] * largest[k] + longest[k] * largest[j] +
                           largest[j] * largest[k] * Single16(4.0F * kUlp);
    const Single16 error = edges * Single16(8.0F * kUlp) + size[axis] * Single16(4.0F * kUlp);
    const Single16 steep = abs(normal[axis]) + error;
    thickness += steep * (Single16(job.scaled_slack[axis]) * Single16(1.0F + 16.0F * kUlp) +
                          largest[axis] * Single16(2.0F * kUlp));
    normal[axis].store(out.normal[axis]);
    (error * Single16(2.0F) + abs(normal[axis]) * Single16(32.0F * kUlp) + Single16(kTiny))
        .store(out.wobble[axis]);
  }
  thickness.store(out.thickness);
}

inline void place_triangles(const MeshView& b, const MeshPairJob& job, std::uint32_t leaf,
                            PlacedTriangles& out) {
  const Corners16 corners = place_corners(b, job, leaf);
  const Box16 box = box_of(corners);
  for (int axis = 0; axis < 3; ++axis) {
    const Single16 low = real_of(box.low[axis]);
    const Single16 high = real_of(box.high[axis]);
    const Single16 largest = max(abs(low), abs(high));
    largest.store(out.largest[axis]);
    const Single16 slack(job.scaled_slack[axis]);
    const Single16 grow = slack + (largest + slack) * Single16(4.0F * kUlp);
    (low - grow).store(out.low[axis]);
    (high + grow).store(out.high[axis]);
    const Single16 reach = (high - low) + grow;
    reach.store(out.reach[axis]);
    (reach * Single16(32.0F * kUlp) + largest * Single16(2.0F * kUlp) + Single16(kTiny))
        .store(out.doubt[axis]);
    for (int k = 0; k < 3; ++k) corners.at[k][axis].store(out.corner[k][axis]);
  }
  out.lanes = present(b.triangle_count, leaf * kMeshFanout);
  out.has_planes = false;
}

/// Which lanes have all three heights on one side, farther than `bound` from zero.
[[gnu::always_inline]] inline Truth<float> aside(const Single16 (&height)[3],
                                                 const Single16& bound) {
  const Truth<float> above = (height[0] > bound) & (height[1] > bound) & (height[2] > bound);
  const Single16 below_bound = -bound;
  return above |
         ((height[0] < below_bound) & (height[1] < below_bound) & (height[2] < below_bound));
}

/// Which triangles of the leaf, out of `boxes`, are not parted from triangle j by a plane.
[[gnu::always_inline]] inline Mask16 unparted(const PairLeaf& leaf, const PlacedTriangles& placed,
                                              const MeshPairJob& job, unsigned j, Mask16 boxes) {
  const Single16 zero(0.0F);
  Single16 above_leaf[3] = {zero, zero, zero};
  Single16 above_placed[3] = {zero, zero, zero};
  Single16 leaf_bound = leaf.doubt;
  Single16 placed_bound(placed.thickness[j]);
  for (int axis = 0; axis < 3; ++axis) {
    const Single16 origin = leaf.corners.at[0][axis];
    const Single16 other_origin(placed.corner[0][axis][j]);
    const Single16 normal(placed.normal[axis][j]);
    for (int k = 0; k < 3; ++k) {
      above_leaf[k] += leaf.normal[axis] * (Single16(placed.corner[k][axis][j]) - origin);
      above_placed[k] += normal * (leaf.corners.at[k][axis] - other_origin);
    }
    leaf_bound += leaf.size[axis] * Single16(placed.doubt[axis][j]) +
                  abs(leaf.normal[axis]) * Single16(job.scaled_slack[axis]);
    const Single16 extent = real_of(leaf.box.high[axis]) - real_of(leaf.box.low[axis]);
    placed_bound += Single16(placed.wobble[axis][j]) * (extent + Single16(placed.reach[axis][j]));
  }
  return boxes & ~bits(aside(above_leaf, leaf_bound) | aside(above_placed, placed_bound));
}

}  // namespace winnow::WINNOW_ISA_NAME
