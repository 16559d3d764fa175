#pragma once

// Sixteen triangles of one mesh against one of another, in the scaled frame of the first: boxes,
// then the planes of both as separating ones. A pair is dropped only where it is apart by more than
// rounding can have added; u is half an ulp of 1. A number that is not finite drops nothing.

#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_walks.kernel.h"
#include "simd/lanes/boxes.h"

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
  Floats normal[3];
  /// Sum of the absolute values of the two products whose difference `normal` is.
  Floats size[3];
  /// Rounding of distances from the plane that is due to the extent of the triangle itself.
  Floats doubt;
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
      r.low[axis] = Floats::load(low[axis]);
      r.high[axis] = Floats::load(high[axis]);
    }
    return r;
  }
};

/// The two products of each component of the cross product of p and q, subtracted and, by absolute
/// value, added.
[[gnu::always_inline]] inline void cross_sizes(const Floats (&p)[3], const Floats (&q)[3],
                                               Floats (&normal)[3], Floats (&size)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    const int j = (axis + 1) % 3;
    const int k = (axis + 2) % 3;
    const Floats plus = p[j] * q[k];
    const Floats minus = p[k] * q[j];
    normal[axis] = plus - minus;
    size[axis] = abs(plus) + abs(minus);
  }
}

inline void load_leaf(const MeshView& a, const MeshPairJob& job, std::uint32_t leaf,
                      PairLeaf& out) {
  out.corners = load_corners(a, leaf);
  const Floats scale(job.scale);
  for (auto& corner : out.corners.at) {
    for (auto& x : corner) x *= scale;
  }
  out.box = box_of(out.corners);
  out.lanes = present(a.triangle_count, leaf * kMeshFanout);
  out.has_planes = false;
}

inline void add_planes(PairLeaf& out) {
  out.has_planes = true;
  Floats first_edge[3];
  Floats last_edge[3];
  for (int axis = 0; axis < 3; ++axis) {
    first_edge[axis] = out.corners.at[1][axis] - out.corners.at[0][axis];
    last_edge[axis] = out.corners.at[2][axis] - out.corners.at[0][axis];
  }
  cross_sizes(first_edge, last_edge, out.normal, out.size);
  out.doubt = Floats(kTiny);
  for (int axis = 0; axis < 3; ++axis) {
    const Floats extent = out.box.high[axis] - out.box.low[axis];
    out.doubt += out.size[axis] * extent * Floats(32.0F * kUlp);
  }
}

/// The corners of b's leaf in double, brought into the scaled frame of a and rounded.
inline Corners16 place_corners(const MeshView& b, const MeshPairJob& job, std::uint32_t leaf) {
  const Corners16 own = load_corners(b, leaf);
  const Doubles scale(static_cast<double>(job.scale));
  Corners16 placed;
  for (int k = 0; k < 3; ++k) {
    Doubles low[3];
    Doubles high[3];
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = to_double<0>(own.at[k][axis]);
      high[axis] = to_double<1>(own.at[k][axis]);
    }
    for (int row = 0; row < 3; ++row) {
      Doubles x(job.offset[row]);
      Doubles y(job.offset[row]);
      for (int axis = 0; axis < 3; ++axis) {
        const Doubles m(job.matrix[row][axis]);
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
  Floats first_edge[3];
  Floats last_edge[3];
  Floats longest[3];
  Floats largest[3];
  for (int axis = 0; axis < 3; ++axis) {
    const Floats origin = Floats::load(out.corner[0][axis]);
    first_edge[axis] = Floats::load(out.corner[1][axis]) - origin;
    last_edge[axis] = Floats::load(out.corner[2][axis]) - origin;
    longest[axis] = max(abs(first_edge[axis]), abs(last_edge[axis]));
    largest[axis] = Floats::load(out.largest[axis]);
  }
  Floats normal[3];
  Floats size[3];
  cross_sizes(first_edge, last_edge, normal, size);
  Floats thickness(kTiny);
  for (int axis = 0; axis < 3; ++axis) {
    const int j = (axis + 1) % 3;
    const int k = (axis + 2) % 3;
    // Edges are wrong by 4 u of the coordinates: each corner was rounded once, the edge once more.
    const Floats edges = longest[j] * largest[k] + longest[k] * largest[j] +
                         largest[j] * largest[k] * Floats(4.0F * kUlp);
    const Floats error = edges * Floats(8.0F * kUlp) + size[axis] * Floats(4.0F * kUlp);
    const Floats steep = abs(normal[axis]) + error;
    thickness += steep * (Floats(job.scaled_slack[axis]) * Floats(1.0F + 16.0F * kUlp) +
                          largest[axis] * Floats(2.0F * kUlp));
    normal[axis].store(out.normal[axis]);
    (error * Floats(2.0F) + abs(normal[axis]) * Floats(32.0F * kUlp) + Floats(kTiny))
        .store(out.wobble[axis]);
  }
  thickness.store(out.thickness);
}

inline void place_triangles(const MeshView& b, const MeshPairJob& job, std::uint32_t leaf,
                            PlacedTriangles& out) {
  const Corners16 corners = place_corners(b, job, leaf);
  const Box16 box = box_of(corners);
  for (int axis = 0; axis < 3; ++axis) {
    const Floats low = box.low[axis];
    const Floats high = box.high[axis];
    const Floats largest = max(abs(low), abs(high));
    largest.store(out.largest[axis]);
    const Floats slack(job.scaled_slack[axis]);
    const Floats grow = slack + (largest + slack) * Floats(4.0F * kUlp);
    (low - grow).store(out.low[axis]);
    (high + grow).store(out.high[axis]);
    const Floats reach = (high - low) + grow;
    reach.store(out.reach[axis]);
    (reach * Floats(32.0F * kUlp) + largest * Floats(2.0F * kUlp) + Floats(kTiny))
        .store(out.doubt[axis]);
    for (int k = 0; k < 3; ++k) corners.at[k][axis].store(out.corner[k][axis]);
  }
  out.lanes = present(b.triangle_count, leaf * kMeshFanout);
  out.has_planes = false;
}

/// Which lanes have all three heights on one side, farther than `bound` from zero.
[[gnu::always_inline]] inline LaneMask<float> aside(const Floats (&height)[3],
                                                    const Floats& bound) {
  const LaneMask<float> above = (height[0] > bound) & (height[1] > bound) & (height[2] > bound);
  const Floats below_bound = -bound;
  return above |
         ((height[0] < below_bound) & (height[1] < below_bound) & (height[2] < below_bound));
}

/// Which triangles of the leaf, out of `boxes`, are not parted from triangle j by a plane.
[[gnu::always_inline]] inline Mask16 unparted(const PairLeaf& leaf, const PlacedTriangles& placed,
                                              const MeshPairJob& job, unsigned j, Mask16 boxes) {
  const Floats zero(0.0F);
  Floats above_leaf[3] = {zero, zero, zero};
  Floats above_placed[3] = {zero, zero, zero};
  Floats leaf_bound = leaf.doubt;
  Floats placed_bound(placed.thickness[j]);
  for (int axis = 0; axis < 3; ++axis) {
    const Floats origin = leaf.corners.at[0][axis];
    const Floats other_origin(placed.corner[0][axis][j]);
    const Floats normal(placed.normal[axis][j]);
    for (int k = 0; k < 3; ++k) {
      above_leaf[k] += leaf.normal[axis] * (Floats(placed.corner[k][axis][j]) - origin);
      above_placed[k] += normal * (leaf.corners.at[k][axis] - other_origin);
    }
    leaf_bound += leaf.size[axis] * Floats(placed.doubt[axis][j]) +
                  abs(leaf.normal[axis]) * Floats(job.scaled_slack[axis]);
    const Floats extent = leaf.box.high[axis] - leaf.box.low[axis];
    placed_bound += Floats(placed.wobble[axis][j]) * (extent + Floats(placed.reach[axis][j]));
  }
  return boxes & ~bits(aside(above_leaf, leaf_bound) | aside(above_placed, placed_bound));
}

}  // namespace winnow::WINNOW_ISA_NAME
