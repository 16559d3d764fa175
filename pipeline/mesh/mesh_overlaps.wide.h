#pragma once

// Triangles of a mesh that overlap a box, or a ball or hull in it (mesh_overlap).
//
// Ball test: a convex shape and a ball are disjoint only if they are separated along the direction
// from the ball's centre to the closest point of the shape. For a triangle, this direction is the
// normal, the direction to a corner, or a direction orthogonal to an edge (Ericson, "Real-Time
// Collision Detection", 2005, 5.2.7 and 5.1.5). Directions need not be exact: if all three corners
// are beyond the ball along any direction, the triangle is outside. Heights along a direction are
// accurate to a few roundings.

#include "partitions/tree/traversal.wide.h"
#include "pipeline/mesh/mesh_hull.wide.h"
#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_traversal.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

using Lanes3 = Floats[3];

[[gnu::always_inline]] inline Floats height(const Lanes3& a, const Lanes3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Corners relative to the ball's centre, scaled so that the ball's radius is about 1.
struct BallCorners {
  Lanes3 at[3];
  Floats square;  ///< of the distance from the centre beyond which a triangle is certainly outside

  BallCorners(const Corners16& corners, const MeshBallJob& ball) {
    Floats largest(ball.largest);
    for (int axis = 0; axis < 3; ++axis) {
      for (int k = 0; k < 3; ++k) {
        at[k][axis] = (corners.at[k][axis] - Floats(ball.center[axis])) * Floats(ball.scale);
        largest = max(largest, abs(at[k][axis]));
      }
    }
    // Bounds the rounding of the centre, of the differences and of heights: less than 16 u of the
    // largest number involved, where u is half an ulp of 1.
    const Floats distance = Floats(ball.radius * (1.0F + 0x1p-20F)) + largest * Floats(0x1p-19F);
    square = distance * distance;
  }

  /// Returns whether all three corners are beyond the ball along a direction of squared length
  /// `length`, given the least of their heights.
  [[gnu::always_inline]] LaneMask<float> beyond(const Floats& least, const Floats& length) const {
    return (least > Floats(0.0F)) & (least * least > length * square);
  }
  [[gnu::always_inline]] LaneMask<float> beyond(const Lanes3& way) const {
    const Floats least = min(min(height(way, at[0]), height(way, at[1])), height(way, at[2]));
    return beyond(least, height(way, way));
  }
};

/// The triangles that are certainly outside the ball; NaN never counts as outside.
[[gnu::always_inline]] inline Mask16 outside_ball(const Corners16& corners,
                                                  const MeshBallJob& ball) {
  const BallCorners t(corners, ball);
  const Floats aa = height(t.at[0], t.at[0]);
  const Floats bb = height(t.at[1], t.at[1]);
  const Floats cc = height(t.at[2], t.at[2]);
  const Floats ab = height(t.at[0], t.at[1]);
  const Floats bc = height(t.at[1], t.at[2]);
  const Floats ca = height(t.at[2], t.at[0]);
  LaneMask<float> out = t.beyond(min(min(aa, ab), ca), aa) | t.beyond(min(min(bb, ab), bc), bb) |
                        t.beyond(min(min(cc, bc), ca), cc);
  Lanes3 edge[3];
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      edge[k][axis] = t.at[(k + 1) % 3][axis] - t.at[k][axis];
    }
    const Floats along = height(t.at[k], edge[k]);
    const Floats length = height(edge[k], edge[k]);
    Lanes3 way;
    for (int axis = 0; axis < 3; ++axis) {
      way[axis] = t.at[k][axis] * length - edge[k][axis] * along;
    }
    out = out | t.beyond(way);
  }
  Lanes3 normal;
  for (int axis = 0; axis < 3; ++axis) {
    const int j = (axis + 1) % 3;
    const int k = (axis + 2) % 3;
    normal[axis] = edge[0][j] * edge[1][k] - edge[0][k] * edge[1][j];
  }
  const LaneMask<float> below = height(normal, t.at[0]) < Floats(0.0F);
  for (auto& x : normal) x = select(below, -x, x);
  return bits(out | t.beyond(normal));
}

/// Collects the few remaining triangles of one leaf after another, and tests sixteen at a time.
class TriangleBatch {
 public:
  TriangleBatch(const MeshBoxJob& job, SlotSink& out) : job_(job), out_(out) {}

  void add(const Corners16& corners, Mask16 hits, std::uint32_t first_slot) {
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        compress_store(hits, corners.at[k][axis], corner_[k][axis] + size_);
      }
    }
    size_ += compress_store(hits, count_from(first_slot), slot_ + size_);
    if (size_ < kLanes) return;
    pass(kLanes);
    size_ -= kLanes;
    for (auto& corner : corner_) {
      for (auto& column : corner) Floats::load(column + kLanes).store(column);
    }
    Uints::load_unaligned(slot_ + kLanes).store_unaligned(slot_);
  }

  void finish() {
    if (size_ != 0) pass(size_);
  }

 private:
  void pass(unsigned count) {
    Corners16 corners;
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        corners.at[k][axis] = Floats::load(corner_[k][axis]);
      }
    }
    const Mask16 lanes = lanes_below(count);
    const Mask16 outside = job_.hull.shape != nullptr ? outside_hull(corners, lanes, job_.hull)
                                                      : outside_ball(corners, job_.ball);
    put_slots(Uints::load_unaligned(slot_), ~outside & lanes, out_);
  }

  const MeshBoxJob& job_;
  SlotSink& out_;
  unsigned size_ = 0;
  // Up to 15 triangles are pending, and every store writes 16.
  alignas(64) float corner_[3][3][2 * kLanes] = {};
  alignas(64) std::uint32_t slot_[2 * kLanes] = {};
};

/// Calls show(corners, hits, first slot) for leaves with triangles whose boxes overlap the box.
template <typename Show>
[[gnu::always_inline]] inline void visit_box(const MeshView& mesh, const MeshBoxJob& job,
                                             Show&& show) {
  traverse<kMaxMeshLevels>(
      mesh.levels,
      [&](std::uint32_t level, std::uint32_t first_node) {
        return overlap(load_nodes(mesh, level, first_node), job.node_low, job.node_high) &
               present(mesh.count[level], first_node);
      },
      [&](std::uint32_t level, std::uint32_t node) {
        if (level != 0) return Next::below;
        const std::uint32_t first_slot = node * kMeshFanout;
        const Corners16 corners = load_corners(mesh, node);
        const Mask16 hits =
            overlap(box_of(corners), job.low, job.high) & present(mesh.triangle_count, first_slot);
        if (hits != 0) show(corners, hits, first_slot);
        return Next::past;
      });
}

inline void find_overlaps(const MeshView& mesh, const MeshBoxJob& job, SlotSink& out) {
  if (job.has_ball || job.hull.shape != nullptr) {
    TriangleBatch batch(job, out);
    visit_box(mesh, job, [&](const Corners16& corners, Mask16 hits, std::uint32_t first_slot) {
      batch.add(corners, hits, first_slot);
    });
    batch.finish();
    return;
  }
  visit_box(mesh, job, [&](const Corners16&, Mask16 hits, std::uint32_t first_slot) {
    put_slots(count_from(first_slot), hits, out);
  });
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
