#pragma once

// Two trees descended at once. Boxes of b's nodes are brought into the frame of a by the matrix and
// its absolute value and tested against sixteen nodes of a; at pairs of leaves the triangles of b,
// brought there in double, against sixteen triangles of a.

#include "pipeline/mesh/mesh_triangles.wide.h"
#include "simd/lanes/boxes.h"
#include "simd/lanes/compress.h"

namespace winnow::WINNOW_ISA_NAME {

/// Boxes of sixteen nodes of b in the units of a's nodes.
struct PlacedNodes {
  alignas(64) float low[3][kLanes];
  alignas(64) float high[3][kLanes];
  Mask16 lanes;

  [[nodiscard]] Box16 box() const {
    Box16 r;
    for (int axis = 0; axis < 3; ++axis) {
      r.low[axis] = Floats::load(low[axis]);
      r.high[axis] = Floats::load(high[axis]);
    }
    return r;
  }
};

/// One half of the lanes. An eighth of a unit covers the rounding of units: doubles resolve them to
/// 2^-13 (floats of the mesh's size lie no closer than 2^-40 of it, and a unit is 2^-16 of its
/// extent) and floats up to 2^17 to 2^-7; where |unit| is larger, both sides agree.
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

/// A node of each tree; one of level l > 0 stands for nodes [16 i, 16 i + 16) of level l - 1, and
/// the only node of level `levels` for the top.
struct NodePair {
  std::uint32_t a;
  std::uint32_t b;
  std::uint32_t level_a;
  std::uint32_t level_b;
};

/// The levels of a pair sum up to 2 * kMaxMeshLevels at most and each step goes down one level of
/// one tree and leaves 16 pairs, or of both and leaves 256: half as many steps. The last step goes
/// to leaves and leaves none.
inline constexpr std::uint32_t kPairRoom = kMaxMeshLevels * kMeshFanout * kMeshFanout;

class PairWalk {
 public:
  PairWalk(const MeshView& a, const MeshView& b, const MeshPairJob& job, SlotPairSink& out)
      : a_(a), b_(b), job_(job), out_(out) {}

  void run() {
    push({0, 0, a_.levels, b_.levels});
    while (size_ != 0) {
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

  /// Which of b's nodes reach into the box of a's node.
  Mask16 reaching(const NodePair& pair, const PlacedNodes& nodes) const {
    if (pair.level_a == a_.levels) return nodes.lanes;
    float low[3];
    float high[3];
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = static_cast<float>(a_.node[pair.level_a][axis][pair.a]);
      high[axis] = static_cast<float>(a_.node[pair.level_a][3 + axis][pair.a]);
    }
    return overlap(nodes.box(), low, high) & nodes.lanes;
  }

  void open_a(const NodePair& pair) {
    const std::uint32_t first_b = pair.b * kMeshFanout;
    place_nodes(a_, b_, job_, pair.level_b - 1, first_b, nodes_);
    // The box of b's node is that of its children.
    float low[3];
    float high[3];
    const std::uint32_t last = 31U - static_cast<std::uint32_t>(__builtin_clz(nodes_.lanes));
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = nodes_.low[axis][0];
      high[axis] = nodes_.high[axis][0];
      for (std::uint32_t j = 1; j <= last; ++j) {
        if (nodes_.low[axis][j] < low[axis]) low[axis] = nodes_.low[axis][j];
        if (nodes_.high[axis][j] > high[axis]) high[axis] = nodes_.high[axis][j];
      }
    }
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

  /// Calls visit(child of b, children of a that it may meet).
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

  /// Which of the placed triangles reach into the box of a's leaf. Decoding, scaling and rounding
  /// keep order, so the box still contains the leaf's scaled corners.
  Mask16 triangles_near(std::uint32_t leaf_a) const {
    float low[3];
    float high[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double origin = static_cast<double>(a_.origin[axis]);
      const double step = static_cast<double>(a_.step[axis]);
      const double scale = static_cast<double>(job_.scale);
      low[axis] = static_cast<float>((origin + a_.node[0][axis][leaf_a] * step) * scale);
      high[axis] = static_cast<float>((origin + a_.node[0][3 + axis][leaf_a] * step) * scale);
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
      const Mask16 hits = unparted(leaf, placed_, job_, j, boxes);
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

}  // namespace winnow::WINNOW_ISA_NAME
