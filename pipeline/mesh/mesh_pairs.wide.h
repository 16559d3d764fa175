#pragma once

// Pairs of overlapping triangles of two meshes (mesh_overlap_pairs): descends both trees at once.
// Boxes of b's nodes are transformed to the frame of a (by the matrix and its absolute value) and
// tested against sixteen nodes of a. At pairs of leaves, b's triangles are transformed in double
// and tested against sixteen triangles of a.
//
// Triangles are tested in the scaled frame of a, sixteen against one: first their boxes, then both
// triangle planes as separating planes. A pair is dropped only if it is separated by more than a
// bound on rounding; u is half an ulp of 1. NaN and infinity drop no pair.

#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_traversal.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

inline constexpr float kUlp = 0x1p-24F;
// Exceeds the underflow of any product here.
inline constexpr float kTiny = 0x1p-110F;

[[gnu::always_inline]] inline Box16 load_box(const float (&low)[3][kLanes],
                                             const float (&high)[3][kLanes]) {
  Box16 box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = Floats::load(low[axis]);
    box.high[axis] = Floats::load(high[axis]);
  }
  return box;
}

/// Triangles of a leaf of a. Their planes are computed on first use.
struct PairLeaf {
  Corners16 corners;
  Box16 box;
  Mask16 lanes;
  bool has_planes;
  Floats normal[3];
  /// Sum of the absolute values of the two products whose difference is `normal`.
  Floats size[3];
  /// Rounding error of distances from the plane due to the extent of the triangle itself.
  Floats offset_error;
};

/// Triangles of a leaf of b, of which one at a time is broadcast. Their planes are computed on
/// first use.
struct PlacedTriangles {
  Mask16 lanes;
  bool has_planes;
  alignas(64) float corner[3][3][kLanes];
  /// The largest absolute value of a coordinate.
  alignas(64) float largest[3][kLanes];
  /// Bounds grown by slack and rounding.
  alignas(64) float low[3][kLanes];
  alignas(64) float high[3][kLanes];
  /// 32 u times the distance that a corner of another triangle with an overlapping box may have
  /// from a corner of this triangle, plus 2 u times the coordinate. Multiplied by PairLeaf::size of
  /// the other triangle, it bounds the error of distances from the other triangle's plane.
  alignas(64) float offset_error[3][kLanes];
  alignas(64) float normal[3][kLanes];
  /// Error bound of the normal. Multiplied by the distance of a corner of another triangle, it
  /// bounds the error of distances from this triangle's plane.
  alignas(64) float normal_error[3][kLanes];
  /// Extent plus slack.
  alignas(64) float reach[3][kLanes];
  /// How far the slack extends along the normal, plus the rounding of the corner that distances are
  /// measured from.
  alignas(64) float thickness[kLanes];

  [[nodiscard]] Box16 box() const { return load_box(low, high); }
};

/// The cross product of p and q: the two products of each component subtracted (`normal`), and
/// their absolute values added (`size`).
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
  out.offset_error = Floats(kTiny);
  for (int axis = 0; axis < 3; ++axis) {
    const Floats extent = out.box.high[axis] - out.box.low[axis];
    out.offset_error += out.size[axis] * extent * Floats(32.0F * kUlp);
  }
}

/// Loads the corners of b's leaf, transforms them in double to the scaled frame of a and rounds
/// them.
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
    // The error of an edge is 4 u of the coordinates: each corner was rounded once, and so was the
    // edge.
    const Floats edges = longest[j] * largest[k] + longest[k] * largest[j] +
                         largest[j] * largest[k] * Floats(4.0F * kUlp);
    const Floats error = edges * Floats(8.0F * kUlp) + size[axis] * Floats(4.0F * kUlp);
    const Floats steep = abs(normal[axis]) + error;
    thickness += steep * (Floats(job.scaled_slack[axis]) * Floats(1.0F + 16.0F * kUlp) +
                          largest[axis] * Floats(2.0F * kUlp));
    normal[axis].store(out.normal[axis]);
    (error * Floats(2.0F) + abs(normal[axis]) * Floats(32.0F * kUlp) + Floats(kTiny))
        .store(out.normal_error[axis]);
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
        .store(out.offset_error[axis]);
    for (int k = 0; k < 3; ++k) corners.at[k][axis].store(out.corner[k][axis]);
  }
  out.lanes = present(b.triangle_count, leaf * kMeshFanout);
  out.has_planes = false;
}

/// The lanes whose three heights are all on one side, farther than `bound` from zero.
[[gnu::always_inline]] inline LaneMask<float> aside(const Floats (&height)[3],
                                                    const Floats& bound) {
  const LaneMask<float> above = (height[0] > bound) & (height[1] > bound) & (height[2] > bound);
  const Floats below_bound = -bound;
  return above |
         ((height[0] < below_bound) & (height[1] < below_bound) & (height[2] < below_bound));
}

/// The triangles of the leaf, among `boxes`, that no triangle plane separates from triangle j.
[[gnu::always_inline]] inline Mask16 not_separated(const PairLeaf& leaf,
                                                   const PlacedTriangles& placed,
                                                   const MeshPairJob& job, unsigned j,
                                                   Mask16 boxes) {
  const Floats zero(0.0F);
  Floats above_leaf[3] = {zero, zero, zero};
  Floats above_placed[3] = {zero, zero, zero};
  Floats leaf_bound = leaf.offset_error;
  Floats placed_bound(placed.thickness[j]);
  for (int axis = 0; axis < 3; ++axis) {
    const Floats origin = leaf.corners.at[0][axis];
    const Floats other_origin(placed.corner[0][axis][j]);
    const Floats normal(placed.normal[axis][j]);
    for (int k = 0; k < 3; ++k) {
      above_leaf[k] += leaf.normal[axis] * (Floats(placed.corner[k][axis][j]) - origin);
      above_placed[k] += normal * (leaf.corners.at[k][axis] - other_origin);
    }
    leaf_bound += leaf.size[axis] * Floats(placed.offset_error[axis][j]) +
                  abs(leaf.normal[axis]) * Floats(job.scaled_slack[axis]);
    const Floats extent = leaf.box.high[axis] - leaf.box.low[axis];
    placed_bound += Floats(placed.normal_error[axis][j]) * (extent + Floats(placed.reach[axis][j]));
  }
  return boxes & ~bits(aside(above_leaf, leaf_bound) | aside(above_placed, placed_bound));
}

/// Boxes of sixteen nodes of b in the units of a's nodes.
struct PlacedNodes {
  alignas(64) float low[3][kLanes];
  alignas(64) float high[3][kLanes];
  Mask16 lanes;

  /// Computes the bounding box of all nodes.
  void merge(float (&least)[3], float (&greatest)[3]) const {
    const std::uint32_t last = 31U - static_cast<std::uint32_t>(__builtin_clz(lanes));
    for (int axis = 0; axis < 3; ++axis) {
      least[axis] = low[axis][0];
      greatest[axis] = high[axis][0];
      for (std::uint32_t j = 1; j <= last; ++j) {
        if (low[axis][j] < least[axis]) least[axis] = low[axis][j];
        if (high[axis][j] > greatest[axis]) greatest[axis] = high[axis][j];
      }
    }
  }

  [[nodiscard]] Box16 box() const { return load_box(low, high); }
};

/// Transforms one half of the lanes. An eighth of a unit covers rounding: a unit is 2^-16 of the
/// mesh's extent and at least 2^-40 of its coordinates, so that doubles resolve units to 2^-13;
/// floats up to 2^17 resolve them to 2^-7. Larger numbers are beyond all node bounds, rounded or
/// not.
template <int Half>
[[gnu::always_inline]] inline void place_half(const MeshView& a, const MeshView& b,
                                              const MeshPairJob& job, const Box16& nodes,
                                              Doubles (&low)[3], Doubles (&high)[3]) {
  Box8 box = in_double<Half>(nodes);
  decode(b, box);
  Doubles center[3];
  Doubles half[3];
  for (int axis = 0; axis < 3; ++axis) {
    center[axis] = (box.low[axis] + box.high[axis]) * Doubles(0.5);
    half[axis] = (box.high[axis] - box.low[axis]) * Doubles(0.5);
  }
  for (int k = 0; k < 3; ++k) {
    Doubles middle(job.offset[k]);
    Doubles radius(job.slack[k]);
    for (int axis = 0; axis < 3; ++axis) {
      const double m = job.matrix[k][axis];
      middle += Doubles(m) * center[axis];
      radius += Doubles(m < 0.0 ? -m : m) * half[axis];
    }
    const Doubles origin(static_cast<double>(a.origin[k]));
    const Doubles per_unit(1.0 / static_cast<double>(a.step[k]));
    low[k] = (middle - radius - origin) * per_unit - Doubles(0.125);
    high[k] = (middle + radius - origin) * per_unit + Doubles(0.125);
  }
}

inline void place_nodes(const MeshView& a, const MeshView& b, const MeshPairJob& job,
                        std::uint32_t level, std::uint32_t first_node, PlacedNodes& out) {
  const Box16 nodes = load_nodes(b, level, first_node);
  Doubles low[2][3];
  Doubles high[2][3];
  place_half<0>(a, b, job, nodes, low[0], high[0]);
  place_half<1>(a, b, job, nodes, low[1], high[1]);
  for (int k = 0; k < 3; ++k) {
    to_single(low[0][k], low[1][k]).store(out.low[k]);
    to_single(high[0][k], high[1][k]).store(out.high[k]);
  }
  out.lanes = present(b.count[level], first_node);
}

/// A node of each tree. A node i of level l > 0 stands for its children, nodes [16 i, 16 i + 16) of
/// level l - 1; the only node of level `levels` stands for the top level.
struct NodePair {
  std::uint32_t a;
  std::uint32_t b;
  std::uint32_t level_a;
  std::uint32_t level_b;
};

/// Size of the stack. The levels of a pair sum to at most 2 * kMaxMeshLevels. A step that descends
/// one level of one tree pushes at most 16 pairs. A step that descends one level of both trees
/// pushes at most 256, and there are at most kMaxMeshLevels such steps from the top to the leaves.
/// The last step visits leaves and pushes nothing.
inline constexpr std::uint32_t kPairRoom = kMaxMeshLevels * kMeshFanout * kMeshFanout;

class PairTraversal {
 public:
  PairTraversal(const MeshView& a, const MeshView& b, const MeshPairJob& job, SlotPairSink& out)
      : a_(a), b_(b), job_(job), out_(out) {}

  void run() {
    push({0, 0, a_.levels, b_.levels});
    while (size_ != 0 && !out_.is_done) {
      const NodePair pair = stack_[--size_];
      if (pair.level_a > pair.level_b) {
        open_a(pair);
      } else if (pair.level_b > pair.level_a) {
        open_b(pair);
      } else if (pair.level_a > 1) {
        open_both(pair);
      } else {
        open_leaves(pair);
      }
    }
  }

 private:
  void push(const NodePair& pair) { stack_[size_++] = pair; }

  /// The nodes of b that overlap the box of a's node.
  Mask16 reaching(const NodePair& pair, const PlacedNodes& nodes) const {
    if (pair.level_a == a_.levels) return nodes.lanes;
    float low[3];
    float high[3];
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] =
          static_cast<float>(bound_of(a_, pair.level_a, pair.a, static_cast<std::size_t>(axis)));
      high[axis] = static_cast<float>(
          bound_of(a_, pair.level_a, pair.a, static_cast<std::size_t>(3 + axis)));
    }
    return overlap(nodes.box(), low, high) & nodes.lanes;
  }

  void open_a(const NodePair& pair) {
    const std::uint32_t first_b = pair.b * kMeshFanout;
    place_nodes(a_, b_, job_, pair.level_b - 1, first_b, nodes_);
    // The box of b's node is the bounding box of its children.
    float low[3];
    float high[3];
    nodes_.merge(low, high);
    const std::uint32_t first_a = pair.a * kMeshFanout;
    Mask16 hits = overlap(load_nodes(a_, pair.level_a - 1, first_a), low, high) &
                  present(a_.count[pair.level_a - 1], first_a);
    for (; hits != 0; hits &= hits - 1) {
      push({first_a + first(hits), pair.b, pair.level_a - 1, pair.level_b});
    }
  }

  void open_b(const NodePair& pair) {
    const std::uint32_t first_b = pair.b * kMeshFanout;
    place_nodes(a_, b_, job_, pair.level_b - 1, first_b, nodes_);
    for (Mask16 hits = reaching(pair, nodes_); hits != 0; hits &= hits - 1) {
      push({pair.a, first_b + first(hits), pair.level_a, pair.level_b - 1});
    }
  }

  /// Calls visit(child of b, mask of the children of a that it may overlap).
  template <typename Visit>
  [[gnu::always_inline]] void for_children(const NodePair& pair, Visit&& visit) {
    const std::uint32_t first_a = pair.a * kMeshFanout;
    const std::uint32_t first_b = pair.b * kMeshFanout;
    place_nodes(a_, b_, job_, pair.level_b - 1, first_b, nodes_);
    const Box16 children = load_nodes(a_, pair.level_a - 1, first_a);
    const Mask16 lanes = present(a_.count[pair.level_a - 1], first_a);
    for (Mask16 rest = reaching(pair, nodes_); rest != 0; rest &= rest - 1) {
      const unsigned j = first(rest);
      const float low[3] = {nodes_.low[0][j], nodes_.low[1][j], nodes_.low[2][j]};
      const float high[3] = {nodes_.high[0][j], nodes_.high[1][j], nodes_.high[2][j]};
      const Mask16 hits = overlap(children, low, high) & lanes;
      if (hits != 0) visit(first_b + j, hits);
    }
  }

  void open_both(const NodePair& pair) {
    for_children(pair, [&](std::uint32_t child, Mask16 hits) {
      for (; hits != 0; hits &= hits - 1) {
        push({pair.a * kMeshFanout + first(hits), child, pair.level_a - 1, pair.level_b - 1});
      }
    });
  }

  void open_leaves(const NodePair& pair) {
    Mask16 ready = 0;
    for_children(pair, [&](std::uint32_t leaf_b, Mask16 hits) {
      place_triangles(b_, job_, leaf_b, placed_);
      for (; hits != 0; hits &= hits - 1) {
        const unsigned i = first(hits);
        const std::uint32_t leaf_a = pair.a * kMeshFanout + i;
        const Mask16 near = triangles_near(leaf_a);
        if (near == 0) continue;
        if ((ready >> i & 1U) == 0) load_leaf(a_, job_, leaf_a, leaves_[i]);
        ready |= 1U << i;
        test_triangles(leaf_a, leaves_[i], leaf_b, near);
      }
    });
  }

  /// The placed triangles whose boxes overlap the box of a's leaf. Decoding, scaling and rounding
  /// are monotonic, so that the box still contains the leaf's scaled corners.
  Mask16 triangles_near(std::uint32_t leaf_a) const {
    float low[3];
    float high[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double origin = static_cast<double>(a_.origin[axis]);
      const double step = static_cast<double>(a_.step[axis]);
      const double scale = static_cast<double>(job_.scale);
      low[axis] = static_cast<float>(
          (origin + bound_of(a_, 0, leaf_a, static_cast<std::size_t>(axis)) * step) * scale);
      high[axis] = static_cast<float>(
          (origin + bound_of(a_, 0, leaf_a, static_cast<std::size_t>(3 + axis)) * step) * scale);
    }
    return overlap(placed_.box(), low, high) & placed_.lanes;
  }

  void test_triangles(std::uint32_t leaf_a, PairLeaf& leaf, std::uint32_t leaf_b, Mask16 near) {
    for (; near != 0; near &= near - 1) {
      const unsigned j = first(near);
      const float low[3] = {placed_.low[0][j], placed_.low[1][j], placed_.low[2][j]};
      const float high[3] = {placed_.high[0][j], placed_.high[1][j], placed_.high[2][j]};
      const Mask16 boxes = overlap(leaf.box, low, high) & leaf.lanes;
      if (boxes == 0) continue;
      if (!leaf.has_planes) add_planes(leaf);
      if (!placed_.has_planes) add_planes(job_, placed_);
      const Mask16 hits = not_separated(leaf, placed_, job_, j, boxes);
      if (hits != 0) put(leaf_a * kMeshFanout, hits, leaf_b * kMeshFanout + j);
    }
  }

  void put(std::uint32_t first_slot, Mask16 hits, std::uint32_t other) {
    if (out_.take != nullptr && out_.size + kLanes > out_.capacity) out_.take(out_.context, out_);
    if (out_.size + kLanes <= out_.capacity) {
      Uints(other).store_unaligned(out_.second + out_.size);
      out_.size += compress_store(hits, count_from(first_slot), out_.first + out_.size);
      return;
    }
    for (; hits != 0; hits &= hits - 1, ++out_.size) {
      if (out_.size >= out_.capacity) continue;
      out_.first[out_.size] = first_slot + first(hits);
      out_.second[out_.size] = other;
    }
  }

  const MeshView& a_;
  const MeshView& b_;
  const MeshPairJob& job_;
  SlotPairSink& out_;
  PlacedNodes nodes_;
  PlacedTriangles placed_;
  PairLeaf leaves_[kMeshFanout];
  std::uint32_t size_ = 0;
  NodePair stack_[kPairRoom];
};

}  // namespace winnow::WINNOW_ISA_NAME::mesh
