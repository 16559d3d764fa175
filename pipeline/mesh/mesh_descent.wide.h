#pragma once

// Traversals of a mesh's tree in approximate order of a measure: the time at which a moving box
// touches triangles (mesh_cast), or the squared distance from a fixed box (mesh_near). Boxes are
// measured in double.

#include "partitions/tree/traversal.wide.h"
#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_traversal.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// Bound on the relative error of a measure.
inline constexpr double kMeasureError = 0x1p-48;

/// The time at which the moving box first touches boxes; infinite if it does not up to `limit`.
class CastMeasure {
 public:
  /// Whether `order` returns a lower bound on the measure of triangles, so that triangles beyond
  /// the limit can be skipped.
  static constexpr bool kOrderIsLeast = false;

  CastMeasure(const MeshCastJob& job, double limit) : job_(job), limit_(limit) {}

  void set_limit(double limit) { limit_ = limit; }
  [[nodiscard]] double limit() const { return limit_; }

  [[gnu::always_inline]] Doubles operator()(const Box8& box) const {
    Doubles entry(0.0);
    Doubles exit(limit_);
    LaneMask<double> overlapping = entry <= entry;
    for (int axis = 0; axis < 3; ++axis) {
      const Doubles near = box.low[axis] - Doubles(job_.max[axis]);
      const Doubles far = box.high[axis] - Doubles(job_.min[axis]);
      if (job_.is_static[axis]) {
        overlapping = overlapping & (near <= Doubles(0.0)) & (far >= Doubles(0.0));
        continue;
      }
      const Doubles inverse(job_.inverse[axis]);
      const Doubles a = near * inverse;
      const Doubles b = far * inverse;
      entry = max(entry, min(a, b) * Doubles(1.0 - kMeasureError));
      exit = min(exit, max(a, b) * Doubles(1.0 + kMeasureError));
    }
    return select(overlapping & (entry <= exit), entry, Doubles(__builtin_inf()));
  }
  /// Returns the times by which triangles are sorted: the time `entry` at which the moving box
  /// touches their boxes, or the time at which it reaches their planes if this is later. The
  /// triangle that is hit first then tends to be visited first, and the limit that its visit
  /// returns excludes others.
  template <int Half>
  [[gnu::always_inline]] Doubles order(const Corners16& corners, const Doubles& entry) const {
    Vec3<double> corner[3];
    for (int k = 0; k < 3; ++k) {
      corner[k] = {to_double<Half>(corners.at[k][0]), to_double<Half>(corners.at[k][1]),
                   to_double<Half>(corners.at[k][2])};
    }
    const double* const low = job_.min;
    const double* const high = job_.max;
    const Vec3<double> normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const Vec3<double> middle{0.5 * low[0] + 0.5 * high[0], 0.5 * low[1] + 0.5 * high[1],
                              0.5 * low[2] + 0.5 * high[2]};
    const Vec3<double> half{0.5 * high[0] - 0.5 * low[0], 0.5 * high[1] - 0.5 * low[1],
                            0.5 * high[2] - 0.5 * low[2]};
    const Vec3<double> way{job_.direction[0], job_.direction[1], job_.direction[2]};
    const Doubles above = dot(normal, middle - corner[0]);
    const Doubles gap =
        abs(above) - (abs(normal.x) * half.x + abs(normal.y) * half.y + abs(normal.z) * half.z);
    const Doubles closing = -(sign_or_one(above) * dot(normal, way));
    const Doubles late(1e300);
    const Doubles time = select(closing > Doubles(0.0), gap / closing, late);
    return max(entry, select(gap > Doubles(0.0), min(time, late), entry));
  }
  /// False for infinite times, even if the limit is infinite.
  [[nodiscard]] bool within(double measure) const {
    return measure <= limit_ && measure < __builtin_inf();
  }

 private:
  const MeshCastJob& job_;
  double limit_;
};

/// The squared distance from a fixed box to scaled boxes. Squares below 1e-300 count as within
/// every limit, because terms of smaller squares may have underflowed.
class NearMeasure {
 public:
  static constexpr bool kOrderIsLeast = true;

  NearMeasure(const MeshNearJob& job, double limit) : job_(job) { set_limit(limit); }

  void set_limit(double limit) {
    limit_ = limit;
    square_ = limit * limit + 1e-300;
  }
  [[nodiscard]] double limit() const { return limit_; }

  [[gnu::always_inline]] Doubles operator()(const Box8& box) const {
    Doubles square(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      const Doubles scale(job_.scale[axis]);
      const Doubles a = box.low[axis] * scale;
      const Doubles b = box.high[axis] * scale;
      const Doubles error = max(abs(a), abs(b)) * Doubles(0x1p-50);
      const Doubles below = Doubles(job_.min[axis]) - (max(a, b) + error);
      const Doubles above = (min(a, b) - error) - Doubles(job_.max[axis]);
      const Doubles gap = max(Doubles(0.0), max(below, above));
      square += gap * gap;
    }
    return square * Doubles(1.0 - kMeasureError);
  }
  /// Lower bound on the squared distance of triangles whose boxes are at squared distance `square`.
  /// If rounding hides that the nearest point is inside a triangle, a point of an edge is used; the
  /// square is then too large by less than a few roundings of the product of two lengths. The error
  /// e of the coordinates changes a square d^2 by 2 d e + e^2, which is bounded by a fraction of
  /// d^2 plus a multiple of e^2.
  template <int Half>
  [[gnu::always_inline]] Doubles order(const Corners16& corners, const Doubles& square) const {
    Vec3<double> corner[3];
    for (int k = 0; k < 3; ++k) {
      corner[k] = {to_double<Half>(corners.at[k][0]) * Doubles(job_.scale[0]),
                   to_double<Half>(corners.at[k][1]) * Doubles(job_.scale[1]),
                   to_double<Half>(corners.at[k][2]) * Doubles(job_.scale[2])};
    }
    const Vec3<double> middle{0.5 * job_.min[0] + 0.5 * job_.max[0],
                              0.5 * job_.min[1] + 0.5 * job_.max[1],
                              0.5 * job_.min[2] + 0.5 * job_.max[2]};
    const Vec3<double> half{0.5 * job_.max[0] - 0.5 * job_.min[0],
                            0.5 * job_.max[1] - 0.5 * job_.min[1],
                            0.5 * job_.max[2] - 0.5 * job_.min[2]};
    Doubles lengths(0.0);
    const Doubles whole = square_to(corner, middle, lengths);
    const Doubles far = norm_l1(middle) + norm_l1(half) + norm_l1(corner[0]) + norm_l1(corner[1]) +
                        norm_l1(corner[2]);
    const Doubles least = whole * Doubles(1.0 - 0x1p-20) - Doubles(0x1p-44) * lengths * lengths -
                          Doubles(0x1p-75) * far * far;
    const Doubles gap =
        sqrt(max(Doubles(0.0), least)) - sqrt(dot(half, half)) * Doubles(1.0 + kMeasureError);
    const Doubles bound = gap * gap * Doubles(1.0 - kMeasureError);
    return select((least > Doubles(0.0)) & (gap > Doubles(0.0)) & (bound > square), bound, square);
  }
  [[nodiscard]] bool within(double measure) const { return measure <= square_; }

 private:
  /// Squared distance from a point to an edge, given the vector from the edge's first corner.
  [[gnu::always_inline]] static Doubles square_to_edge(const Vec3<double>& from,
                                                       const Vec3<double>& edge) {
    const Doubles zero(0.0);
    const Doubles one(1.0);
    const Doubles share = dot(from, edge) / dot(edge, edge);
    const Doubles after = select(share > zero, share, zero);
    const Vec3<double> rest = from - edge * select(after < one, after, one);
    return dot(rest, rest);
  }
  /// Squared distance from a point to triangles, and the sum of the lengths it is computed from.
  [[gnu::always_inline]] static Doubles square_to(const Vec3<double> (&corner)[3],
                                                  const Vec3<double>& point, Doubles& lengths) {
    const Vec3<double> ab = corner[1] - corner[0];
    const Vec3<double> bc = corner[2] - corner[1];
    const Vec3<double> ca = corner[0] - corner[2];
    const Vec3<double> a = point - corner[0];
    const Vec3<double> b = point - corner[1];
    const Vec3<double> c = point - corner[2];
    lengths = norm_l1(ab) + norm_l1(bc) + norm_l1(ca) + norm_l1(a);
    const Doubles edges =
        min(min(square_to_edge(a, ab), square_to_edge(b, bc)), square_to_edge(c, ca));
    const Vec3<double> normal = cross(bc, ca);
    const Doubles size = dot(normal, normal);
    const Doubles zero(0.0);
    const auto is_over = (dot(cross(ab, a), normal) >= zero) & (dot(cross(bc, b), normal) >= zero) &
                         (dot(cross(ca, c), normal) >= zero);
    const Doubles height = dot(normal, a);
    // The plane of a triangle with hardly any area is unreliable, and a triangle without area may
    // stand for its box (trees over other objects): return 0 for both.
    constexpr double kMinSize = 1e-250;
    const auto has_plane = size > Doubles(kMinSize);
    const Doubles plane = height * height / size;
    return select(has_plane, select(is_over & (plane < edges), plane, edges), zero);
  }

  const MeshNearJob& job_;
  double limit_ = 0.0;
  double square_ = 0.0;
};

/// Lanes of a block that are within the limit, in the order in which to visit them.
struct OrderedLanes {
  double measure[kLanes];
  std::uint32_t lane[kLanes];
  std::uint32_t count = 0;
};

/// Selects the lanes in `lanes` whose measure `value` is within the limit, and sorts them by
/// `order`.
template <typename Measure>
inline void order_lanes(const Measure& measure, const double* value, const double* order,
                        Mask16 lanes, OrderedLanes& out) {
  out.count = 0;
  for (; lanes != 0; lanes &= lanes - 1) {
    const unsigned lane = first(lanes);
    if (!measure.within(value[lane])) continue;
    std::uint32_t at = out.count++;
    for (; at != 0 && out.measure[at - 1] > order[lane]; --at) {
      out.measure[at] = out.measure[at - 1];
      out.lane[at] = out.lane[at - 1];
    }
    out.measure[at] = order[lane];
    out.lane[at] = lane;
  }
}

/// The stack of open nodes, nearest on top. While a node is opened, at most 15 other nodes of its
/// level are on the stack; this bounds the stack.
template <typename Measure>
class OpenMeshNodes {
 public:
  OpenMeshNodes(const MeshView& mesh, const Measure& measure) : mesh_(mesh), measure_(measure) {}

  bool open(std::uint32_t level, std::uint32_t first_node, std::uint32_t& node) {
    const Box16 nodes = load_nodes(mesh_, level, first_node);
    Box8 low = in_double<0>(nodes);
    Box8 high = in_double<1>(nodes);
    decode(mesh_, low);
    decode(mesh_, high);
    alignas(64) double value[kLanes];
    measure_(low).store(value);
    measure_(high).store(value + 8);
    OrderedLanes found;
    order_lanes(measure_, value, value, present(mesh_.count[level], first_node), found);
    if (found.count == 0) return false;
    for (std::uint32_t i = found.count; i-- > 1;) {
      waiting_[size_++] = {found.measure[i], first_node + found.lane[i], level};
    }
    node = first_node + found.lane[0];
    return true;
  }

  /// Returns false if no node is left, or if the limit is negative.
  bool pop(std::uint32_t& level, std::uint32_t& node) {
    while (size_ != 0 && measure_.limit() >= 0.0) {
      const WaitingNode& next = waiting_[--size_];
      if (!measure_.within(next.measure)) continue;
      level = next.level;
      node = next.node;
      return true;
    }
    return false;
  }

 private:
  struct WaitingNode {
    double measure;
    std::uint32_t node;
    std::uint32_t level;
  };

  const MeshView& mesh_;
  const Measure& measure_;
  WaitingNode waiting_[kMaxMeshLevels * kMeshFanout];
  std::uint32_t size_ = 0;
};

/// Passes a leaf's triangles within the limit to the visitor.
template <typename Measure>
inline void visit_leaf(const MeshView& mesh, std::uint32_t leaf, Measure& measure,
                       const SlotVisitor& visitor) {
  const Corners16 corners = load_corners(mesh, leaf);
  const Box16 box = box_of(corners);
  const std::uint32_t first_slot = leaf * kMeshFanout;
  const Doubles low = measure(in_double<0>(box));
  const Doubles high = measure(in_double<1>(box));
  alignas(64) double value[kLanes];
  alignas(64) double order[kLanes];
  low.store(value);
  high.store(value + 8);
  measure.template order<0>(corners, low).store(order);
  measure.template order<1>(corners, high).store(order + 8);
  OrderedLanes found;
  order_lanes(measure, Measure::kOrderIsLeast ? order : value, order,
              present(mesh.triangle_count, first_slot), found);
  if (found.count == 0) return;
  for (std::uint32_t i = 0; i < found.count; ++i) found.lane[i] += first_slot;
  if (!Measure::kOrderIsLeast) {
    measure.set_limit(visitor.visit(visitor.context, found.lane, found.count, measure.limit()));
    return;
  }
  for (std::uint32_t i = 0; i < found.count && measure.limit() >= 0.0; ++i) {
    if (!measure.within(found.measure[i])) return;
    measure.set_limit(visitor.visit(visitor.context, found.lane + i, 1, measure.limit()));
  }
}

/// Passes the triangles within the measure's limit to the visitor, nearest leaf first.
template <typename Measure>
inline void visit_nearest_first(const MeshView& mesh, Measure& measure,
                                const SlotVisitor& visitor) {
  if (!(measure.limit() >= 0.0)) return;
  OpenMeshNodes<Measure> open(mesh, measure);
  descend(mesh.levels, open, [&](std::uint32_t leaf) {
    visit_leaf(mesh, leaf, measure, visitor);
    return true;
  });
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
