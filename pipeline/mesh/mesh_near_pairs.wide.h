#pragma once

// The nearest triangles of two meshes: two trees descended at once, the pair of boxes first that is
// the least apart, as long as it is within the limit. Lengths are those of the scaled frame of a
// (see mesh_pairs.wide.h), squares of them rounded down.
//
// Triangles are dropped if a direction parts them by more than the limit and what rounding can have
// added: the one along which the nearest pair so far is apart, which parts nearly all pairs of
// surfaces that bend away from each other, or that between their middles.

#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_pairs.wide.h"
#include "pipeline/mesh/mesh_traversal.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// More than the relative error of a square.
inline constexpr float kSquareError = 0x1p-16F;

/// A pair of nodes, leaves or triangles, and the square of how far their boxes are apart at least.
struct ApartPair {
  float square;
  std::uint32_t a;
  std::uint32_t b;
};

/// Up to 16 x 16 pairs.
struct ApartPairs {
  std::uint32_t size = 0;
  ApartPair pair[kLanes * kLanes];

  void add(const Floats& squares, Mask16 hits, std::uint32_t first_a, std::uint32_t b) {
    alignas(64) float square[kLanes];
    squares.store(square);
    for (; hits != 0; hits &= hits - 1) {
      pair[size++] = {square[first(hits)], first_a + first(hits), b};
    }
  }
  /// The farthest first (Shell, "A high-speed sorting procedure", CACM 1959).
  void sort() {
    static constexpr std::uint32_t kGaps[6] = {132, 57, 23, 10, 4, 1};
    for (const std::uint32_t gap : kGaps) {
      for (std::uint32_t i = gap; i < size; ++i) {
        const ApartPair moved = pair[i];
        std::uint32_t at = i;
        for (; at >= gap && pair[at - gap].square < moved.square; at -= gap) {
          pair[at] = pair[at - gap];
        }
        pair[at] = moved;
      }
    }
  }
};

class NearPairTraversal {
 public:
  NearPairTraversal(const MeshView& a, const MeshView& b, const MeshPairJob& job, double limit,
                    const SlotPairVisitor& visitor)
      : a_(a), b_(b), job_(job), visitor_(visitor) {
    for (int axis = 0; axis < 3; ++axis) {
      length_[axis] = a.step[axis] * job.scale * (1.0F - 0x1p-20F);
      slack_ += job.scaled_slack[axis];
    }
    set_limit(limit);
  }

  void run() {
    push({0, 0, a_.levels, b_.levels}, 0.0F);
    while (size_ != 0 && limit_ >= 0.0) {
      const Waiting next = stack_[--size_];
      if (!(next.square <= square_)) continue;
      if (next.nodes.level_a > next.nodes.level_b) {
        open_a(next.nodes);
      } else if (next.nodes.level_b > next.nodes.level_a) {
        open_b(next.nodes);
      } else {
        open_both(next.nodes);
      }
    }
  }

 private:
  struct Waiting {
    float square;
    NodePair nodes;
  };

  void push(const NodePair& nodes, float square) { stack_[size_++] = {square, nodes}; }

  void set_limit(double limit) {
    limit_ = limit;
    const double scaled = limit * static_cast<double>(job_.scale) * (1.0 + 0x1p-20);
    most_ = scaled < 1e18 ? static_cast<float>(scaled) : __builtin_inff();
    square_ = most_ * most_ * (1.0F + kSquareError) + 1e-36F;
  }

  /// Squared distances of sixteen boxes from one, a unit of each axis being `length` long.
  [[gnu::always_inline]] static Floats squares(const Box16& boxes, const float (&low)[3],
                                               const float (&high)[3], const float (&length)[3]) {
    Floats sum(0.0F);
    for (int axis = 0; axis < 3; ++axis) {
      const Floats above = Floats(low[axis]) - boxes.high[axis];
      const Floats below = boxes.low[axis] - Floats(high[axis]);
      const Floats gap = max(Floats(0.0F), max(above, below)) * Floats(length[axis]);
      sum += gap * gap;
    }
    return sum * Floats(1.0F - kSquareError);
  }

  void open_a(const NodePair& pair) {
    place_nodes(a_, b_, job_, pair.level_b - 1, pair.b * kMeshFanout, nodes_);
    float low[3];
    float high[3];
    nodes_.merge(low, high);
    const std::uint32_t first_a = pair.a * kMeshFanout;
    const std::uint32_t level = pair.level_a - 1;
    const Floats apart = squares(load_nodes(a_, level, first_a), low, high, length_);
    found_.size = 0;
    found_.add(apart, bits(apart <= Floats(square_)) & present(a_.count[level], first_a), first_a,
               pair.b);
    push_found(level, pair.level_b);
  }

  void open_b(const NodePair& pair) {
    const std::uint32_t first_b = pair.b * kMeshFanout;
    place_nodes(a_, b_, job_, pair.level_b - 1, first_b, nodes_);
    Floats apart(0.0F);
    if (pair.level_a != a_.levels) {
      float low[3];
      float high[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = static_cast<float>(bound_of(a_, pair.level_a, pair.a, axis));
        high[axis] = static_cast<float>(bound_of(a_, pair.level_a, pair.a, 3 + axis));
      }
      apart = squares(nodes_.box(), low, high, length_);
    }
    alignas(64) float square[kLanes];
    apart.store(square);
    found_.size = 0;
    Mask16 hits = bits(apart <= Floats(square_)) & nodes_.lanes;
    for (; hits != 0; hits &= hits - 1) {
      found_.pair[found_.size++] = {square[first(hits)], pair.a, first_b + first(hits)};
    }
    push_found(pair.level_a, pair.level_b - 1);
  }

  void open_both(const NodePair& pair) {
    const std::uint32_t level = pair.level_a - 1;
    const std::uint32_t first_a = pair.a * kMeshFanout;
    const std::uint32_t first_b = pair.b * kMeshFanout;
    place_nodes(a_, b_, job_, level, first_b, nodes_);
    const Box16 children = load_nodes(a_, level, first_a);
    const Mask16 lanes = present(a_.count[level], first_a);
    found_.size = 0;
    for (Mask16 rest = nodes_.lanes; rest != 0; rest &= rest - 1) {
      const unsigned j = first(rest);
      const float low[3] = {nodes_.low[0][j], nodes_.low[1][j], nodes_.low[2][j]};
      const float high[3] = {nodes_.high[0][j], nodes_.high[1][j], nodes_.high[2][j]};
      const Floats apart = squares(children, low, high, length_);
      found_.add(apart, bits(apart <= Floats(square_)) & lanes, first_a, first_b + j);
    }
    if (level != 0) {
      push_found(level, level);
    } else {
      open_leaves(first_a, first_b);
    }
  }

  void push_found(std::uint32_t level_a, std::uint32_t level_b) {
    found_.sort();
    for (std::uint32_t i = 0; i < found_.size; ++i) {
      push({found_.pair[i].a, found_.pair[i].b, level_a, level_b}, found_.pair[i].square);
    }
  }

  void open_leaves(std::uint32_t first_a, std::uint32_t first_b) {
    found_.sort();
    Mask16 ready_a = 0;
    Mask16 ready_b = 0;
    for (std::uint32_t i = found_.size; i-- > 0 && found_.pair[i].square <= square_;) {
      const std::uint32_t leaf_a = found_.pair[i].a;
      const std::uint32_t leaf_b = found_.pair[i].b;
      const std::uint32_t of_a = leaf_a - first_a;
      const std::uint32_t of_b = leaf_b - first_b;
      if ((ready_a >> of_a & 1U) == 0) load_leaf(a_, job_, leaf_a, leaves_[of_a]);
      if ((ready_b >> of_b & 1U) == 0) placed_[of_b] = place_corners(b_, job_, leaf_b);
      ready_a |= 1U << of_a;
      ready_b |= 1U << of_b;
      find_triangles(leaves_[of_a], placed_[of_b], leaf_a * kMeshFanout, leaf_b * kMeshFanout);
      show_triangles();
      if (!(limit_ >= 0.0)) return;
    }
  }

  /// Triangles of two leaves that may be within the limit.
  void find_triangles(const PairLeaf& leaf, const Corners16& others, std::uint32_t first_a,
                      std::uint32_t first_b) {
    alignas(64) float corner[3][3][kLanes];
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) others.at[k][axis].store(corner[k][axis]);
    }
    Floats size(0.0F);
    Floats middle[3];
    for (int axis = 0; axis < 3; ++axis) {
      size += max(abs(leaf.box.low[axis]), abs(leaf.box.high[axis]));
      middle[axis] = leaf.corners.at[0][axis] + leaf.corners.at[1][axis] + leaf.corners.at[2][axis];
    }
    triangles_.size = 0;
    for (Mask16 rest = present(b_.triangle_count, first_b); rest != 0; rest &= rest - 1) {
      const unsigned j = first(rest);
      float other[3][3];
      float low[3];
      float high[3];
      float other_size = 0.0F;
      for (int axis = 0; axis < 3; ++axis) {
        for (int k = 0; k < 3; ++k) other[k][axis] = corner[k][axis][j];
        low[axis] = least(other[0][axis], other[1][axis], other[2][axis]);
        high[axis] = -least(-other[0][axis], -other[1][axis], -other[2][axis]);
        other_size += high[axis] > -low[axis] ? high[axis] : -low[axis];
      }
      // Sums of three products of coordinates, and the corners of b, are rounded by less.
      const Floats doubt = (size + Floats(other_size)) * Floats(0x1p-19F) + Floats(slack_);
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] -= slack_ + other_size * 0x1p-20F;
        high[axis] += slack_ + other_size * 0x1p-20F;
      }
      static constexpr float kUnits[3] = {1.0F, 1.0F, 1.0F};
      const Floats apart = squares(leaf.box, low, high, kUnits);
      Mask16 hits = bits(apart <= Floats(square_)) & leaf.lanes;
      if (hits == 0) continue;
      const Floats reach = (Floats(most_) + doubt) * Floats(1.0F + 0x1p-14F);
      const Floats known[3] = {visitor_.direction[0], visitor_.direction[1], visitor_.direction[2]};
      hits &= ~bits(parted_by(known, leaf, other) > reach);
      if (hits == 0) continue;
      Floats between[3];
      Floats length(0.0F);
      for (int axis = 0; axis < 3; ++axis) {
        between[axis] = Floats(other[0][axis] + other[1][axis] + other[2][axis]) - middle[axis];
        length += between[axis] * between[axis];
      }
      hits &= ~bits(parted_by(between, leaf, other) > reach * sqrt(length));
      triangles_.add(apart, hits, first_a, first_b + j);
    }
  }

  static float least(float a, float b, float c) {
    const float ab = a < b ? a : b;
    return ab < c ? ab : c;
  }

  /// How far a triangle lies beyond those of a leaf along a direction, in units of its length.
  [[gnu::always_inline]] static Floats parted_by(const Floats (&direction)[3], const PairLeaf& leaf,
                                                 const float (&other)[3][3]) {
    Floats own[3];
    Floats others[3];
    for (int k = 0; k < 3; ++k) {
      const auto& corner = leaf.corners.at[k];
      own[k] = direction[0] * corner[0] + direction[1] * corner[1] + direction[2] * corner[2];
      others[k] = direction[0] * Floats(other[k][0]) + direction[1] * Floats(other[k][1]) +
                  direction[2] * Floats(other[k][2]);
    }
    return min(min(others[0], others[1]), others[2]) - max(max(own[0], own[1]), own[2]);
  }

  void show_triangles() {
    triangles_.sort();
    for (std::uint32_t i = triangles_.size; i-- > 0;) {
      const ApartPair& pair = triangles_.pair[i];
      if (!(pair.square <= square_ && limit_ >= 0.0)) return;
      set_limit(visitor_.visit(visitor_.context, pair.a, pair.b, limit_));
    }
  }

  const MeshView& a_;
  const MeshView& b_;
  const MeshPairJob& job_;
  const SlotPairVisitor& visitor_;
  float length_[3];
  float slack_ = 0.0F;
  double limit_ = 0.0;
  /// The limit in the scaled frame, and its square.
  float most_ = 0.0F;
  float square_ = 0.0F;
  PlacedNodes nodes_;
  PairLeaf leaves_[kMeshFanout];
  Corners16 placed_[kMeshFanout];
  ApartPairs found_;
  ApartPairs triangles_;
  std::uint32_t size_ = 0;
  Waiting stack_[kPairRoom];
};

}  // namespace winnow::WINNOW_ISA_NAME::mesh
