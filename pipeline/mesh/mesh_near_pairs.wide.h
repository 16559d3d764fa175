#pragma once

// The nearest triangles of two meshes (mesh_near_pairs): descends both trees at once, depth first.
// Among the children of two nodes, the pair with the least distance is opened first; pairs beyond
// the limit are skipped. Lengths are in the scaled frame of a (see mesh_pairs.wide.h); squared
// distances are lower bounds.
//
// Pairs of triangles are dropped if a direction separates them by more than the limit plus a bound
// on rounding. Two directions are tested: the direction that separates the nearest pair found up to
// now, which also separates nearly all other pairs if the surfaces curve away from each other, and
// the direction between the triangles' centres.

#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_pairs.wide.h"
#include "pipeline/mesh/mesh_traversal.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// Bound on the relative error of a square.
inline constexpr float kSquareError = 0x1p-16F;

/// A pair of nodes, leaves or triangles, and a lower bound on the squared distance of their boxes.
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
  /// Sorts in descending order of distance (Shell, "A high-speed sorting procedure", CACM 1959).
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
      const WaitingPair next = stack_[--size_];
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
  struct WaitingPair {
    float square;
    NodePair nodes;
  };

  void push(const NodePair& nodes, float square) { stack_[size_++] = {square, nodes}; }

  void set_limit(double limit) {
    limit_ = limit;
    const double scaled = limit * static_cast<double>(job_.scale) * (1.0 + 0x1p-20);
    if (scaled < static_cast<double>(most_)) set_most(static_cast<float>(scaled));
  }
  void set_most(float most) {
    most_ = most;
    square_ = most_ * most_ * (1.0F + kSquareError) + 1e-36F;
  }

  /// Squared distances of sixteen boxes from one box; a unit of each axis has length `length`.
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
    // `along` is the direction in node units. The support of a box along it is at a corner.
    float along[3];
    float error_bound = slack_;
    Floats own_reach(0.0F);
    for (int axis = 0; axis < 3; ++axis) {
      along[axis] = visitor_.direction[axis] * a_.step[axis] * job_.scale;
      const float size = along[axis] < 0.0F ? -along[axis] : along[axis];
      error_bound += size;
      own_reach +=
          Floats(along[axis]) * (along[axis] < 0.0F ? children.low[axis] : children.high[axis]);
    }
    for (Mask16 rest = nodes_.lanes; rest != 0; rest &= rest - 1) {
      const unsigned j = first(rest);
      float reach = 0.0F;
      for (int axis = 0; axis < 3; ++axis) {
        reach += along[axis] * (along[axis] < 0.0F ? nodes_.high[axis][j] : nodes_.low[axis][j]);
      }
      const Mask16 parted =
          bits(Floats(reach) - own_reach > Floats((most_ + error_bound) * (1.0F + 0x1p-14F)));
      if ((lanes & ~parted) == 0) continue;
      const float low[3] = {nodes_.low[0][j], nodes_.low[1][j], nodes_.low[2][j]};
      const float high[3] = {nodes_.high[0][j], nodes_.high[1][j], nodes_.high[2][j]};
      const Floats apart = squares(children, low, high, length_);
      found_.add(apart, bits(apart <= Floats(square_)) & lanes & ~parted, first_a, first_b + j);
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

  /// Finds pairs of triangles of two leaves that may be within the limit.
  void find_triangles(const PairLeaf& leaf, const Corners16& others, std::uint32_t first_a,
                      std::uint32_t first_b) {
    alignas(64) float corner[3][3][kLanes];
    alignas(64) float lows[3][kLanes];
    alignas(64) float highs[3][kLanes];
    alignas(64) float other_size[kLanes];
    const Box16 other_box = box_of(others);
    Floats size(0.0F);
    Floats sum(0.0F);
    Floats middle[3];
    for (int axis = 0; axis < 3; ++axis) {
      for (int k = 0; k < 3; ++k) others.at[k][axis].store(corner[k][axis]);
      other_box.low[axis].store(lows[axis]);
      other_box.high[axis].store(highs[axis]);
      sum += max(abs(other_box.low[axis]), abs(other_box.high[axis]));
      size += max(abs(leaf.box.low[axis]), abs(leaf.box.high[axis]));
      middle[axis] = leaf.corners.at[0][axis] + leaf.corners.at[1][axis] + leaf.corners.at[2][axis];
    }
    sum.store(other_size);
    if (!has_direction() && !visitor_.leaves_out) {
      cut_by_corners(leaf, corner, reduce_max(size) + reduce_max(sum));
    }
    triangles_.size = 0;
    const Floats known[3] = {visitor_.direction[0], visitor_.direction[1], visitor_.direction[2]};
    const Floats own_reach = farthest(known, leaf.corners);
    alignas(64) float other_reach[kLanes];
    const Floats backward[3] = {-known[0], -known[1], -known[2]};
    (-farthest(backward, others)).store(other_reach);
    for (Mask16 rest = present(b_.triangle_count, first_b); rest != 0; rest &= rest - 1) {
      const unsigned j = first(rest);
      // Exceeds the rounding of sums of three products of coordinates, and of the corners of b.
      const Floats error_bound = (size + Floats(other_size[j])) * Floats(0x1p-19F) + Floats(slack_);
      const Floats reach = (Floats(most_) + error_bound) * Floats(1.0F + 0x1p-14F);
      Mask16 hits = ~bits(Floats(other_reach[j]) - own_reach > reach) & leaf.lanes;
      if (hits == 0) continue;
      const float grow = slack_ + other_size[j] * 0x1p-20F;
      const float low[3] = {lows[0][j] - grow, lows[1][j] - grow, lows[2][j] - grow};
      const float high[3] = {highs[0][j] + grow, highs[1][j] + grow, highs[2][j] + grow};
      static constexpr float kUnits[3] = {1.0F, 1.0F, 1.0F};
      const Floats apart = squares(leaf.box, low, high, kUnits);
      hits &= bits(apart <= Floats(square_));
      if (hits == 0) continue;
      Corners16 other;
      Floats between[3];
      Floats length(0.0F);
      for (int axis = 0; axis < 3; ++axis) {
        for (int k = 0; k < 3; ++k) other.at[k][axis] = Floats(corner[k][axis][j]);
        between[axis] = other.at[0][axis] + other.at[1][axis] + other.at[2][axis] - middle[axis];
        length += between[axis] * between[axis];
      }
      const Floats back[3] = {-between[0], -between[1], -between[2]};
      const Floats parted = -farthest(back, other) - farthest(between, leaf.corners);
      hits &= ~bits(parted > reach * sqrt(length));
      triangles_.add(apart, hits, first_a, first_b + j);
    }
  }

  [[nodiscard]] bool has_direction() const {
    const float* const d = visitor_.direction;
    return d[0] != 0.0F || d[1] != 0.0F || d[2] != 0.0F;
  }

  /// Lowers the limit to a distance between corners of the two leaves, which is an upper bound of
  /// the distance of the meshes. This prunes most pairs of nodes and triangles before the first
  /// distance of two triangles is computed.
  void cut_by_corners(const PairLeaf& leaf, const float (&corner)[3][3][kLanes], float size) {
    Floats nearest(__builtin_inff());
    for (int j = 0; j < kLanes; ++j) {
      for (const auto& own : leaf.corners.at) {
        Floats square(0.0F);
        for (int axis = 0; axis < 3; ++axis) {
          const Floats between = own[axis] - Floats(corner[0][axis][j]);
          square += between * between;
        }
        nearest = min(nearest, square);
      }
    }
    const float apart =
        reduce_min(sqrt(nearest)) * (1.0F + kSquareError) + slack_ + size * 0x1p-19F;
    if (apart < most_) set_most(apart);
  }

  /// Returns the support of triangles along a direction, multiplied by the length of the direction.
  [[gnu::always_inline]] static Floats farthest(const Floats (&direction)[3],
                                                const Corners16& corners) {
    Floats at[3];
    for (int k = 0; k < 3; ++k) {
      at[k] = direction[0] * corners.at[k][0] + direction[1] * corners.at[k][1] +
              direction[2] * corners.at[k][2];
    }
    return max(max(at[0], at[1]), at[2]);
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
  /// `most_` is the least of the limits in the scaled frame and the upper bounds that
  /// cut_by_corners computed; `square_` is the square of `most_` plus a bound on rounding.
  float most_ = __builtin_inff();
  float square_ = __builtin_inff();
  PlacedNodes nodes_;
  PairLeaf leaves_[kMeshFanout];
  Corners16 placed_[kMeshFanout];
  ApartPairs found_;
  ApartPairs triangles_;
  std::uint32_t size_ = 0;
  WaitingPair stack_[kPairRoom];
};

}  // namespace winnow::WINNOW_ISA_NAME::mesh
