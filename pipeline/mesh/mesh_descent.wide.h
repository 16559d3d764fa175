#pragma once

// Descents that come upon triangles roughly in the order of a measure: the time at which a moving
// box meets theirs, or the squared distance from it. Boxes are measured in double.

#include "partitions/tree/traversal.wide.h"
#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_traversal.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// More than the relative error of the few operations that make a measure.
inline constexpr double kMeasureError = 0x1p-48;

/// When the moving box first meets boxes; above `limit` where it does not by then.
class SweepMeasure {
 public:
  SweepMeasure(const MeshSweepJob& job, double limit) : job_(job), limit_(limit) {}

  void set_limit(double limit) { limit_ = limit; }
  [[nodiscard]] double limit() const { return limit_; }

  [[gnu::always_inline]] Doubles operator()(const Box8& box) const {
    Doubles entry(0.0);
    Doubles exit(limit_);
    LaneMask<double> met = entry <= entry;
    for (int axis = 0; axis < 3; ++axis) {
      const Doubles near = box.low[axis] - Doubles(job_.max[axis]);
      const Doubles far = box.high[axis] - Doubles(job_.min[axis]);
      if (job_.is_static[axis]) {
        met = met & (near <= Doubles(0.0)) & (far >= Doubles(0.0));
        continue;
      }
      const Doubles inverse(job_.inverse[axis]);
      const Doubles a = near * inverse;
      const Doubles b = far * inverse;
      entry = max(entry, min(a, b) * Doubles(1.0 - kMeasureError));
      exit = min(exit, max(a, b) * Doubles(1.0 + kMeasureError));
    }
    return select(met & (entry <= exit), entry, Doubles(__builtin_inf()));
  }
  /// When to look at triangles whose boxes are met at these times: not before the box comes to
  /// their planes. What is met first comes first so, and others need not be looked at closely.
  template <int Half>
  [[gnu::always_inline]] Doubles order(const Corners16& corners, const Doubles& met) const {
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
    return max(met, select(gap > Doubles(0.0), min(time, late), met));
  }
  /// No time is infinite, whatever the limit.
  [[nodiscard]] bool within(double measure) const {
    return measure <= limit_ && measure < __builtin_inf();
  }

 private:
  const MeshSweepJob& job_;
  double limit_;
};

/// The squared distance from a box that stands to boxes that are scaled. What underflows is taken
/// for near: squares below 1e-300 are within every limit.
class NearMeasure {
 public:
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
  template <int Half>
  [[gnu::always_inline]] Doubles order(const Corners16& /*corners*/, const Doubles& square) const {
    return square;
  }
  [[nodiscard]] bool within(double measure) const { return measure <= square_; }

 private:
  const MeshNearJob& job_;
  double limit_ = 0.0;
  double square_ = 0.0;
};

/// Lanes of a block that are within the limit, the first to be looked at first.
struct OrderedLanes {
  double measure[kLanes];
  std::uint32_t lane[kLanes];
  std::uint32_t count = 0;
};

/// By `order`, of `lanes` of which a measure of `value` is within the limit.
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

/// The open nodes of a descent, of which the nearest is the last. Every level leaves at most 15
/// nodes waiting while one is descended into, which bounds the stack.
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

  /// A negative limit ends the descent.
  bool take(std::uint32_t& level, std::uint32_t& node) {
    while (size_ != 0 && measure_.limit() >= 0.0) {
      const Waiting& next = waiting_[--size_];
      if (!measure_.within(next.measure)) continue;
      level = next.level;
      node = next.node;
      return true;
    }
    return false;
  }

 private:
  struct Waiting {
    double measure;
    std::uint32_t node;
    std::uint32_t level;
  };

  const MeshView& mesh_;
  const Measure& measure_;
  Waiting waiting_[kMaxMeshLevels * kMeshFanout];
  std::uint32_t size_ = 0;
};

/// Shows a leaf's triangles within the limit.
template <typename Measure>
inline void show_leaf(const MeshView& mesh, std::uint32_t leaf, Measure& measure,
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
  order_lanes(measure, value, order, present(mesh.triangle_count, first_slot), found);
  if (found.count == 0) return;
  for (std::uint32_t i = 0; i < found.count; ++i) found.lane[i] += first_slot;
  measure.set_limit(visitor.visit(visitor.context, found.lane, found.count, measure.limit()));
}

/// Shows the triangles within the measure's limit, the nearest leaf first.
template <typename Measure>
inline void show_in_order(const MeshView& mesh, Measure& measure, const SlotVisitor& visitor) {
  if (!(measure.limit() >= 0.0)) return;
  OpenMeshNodes<Measure> open(mesh, measure);
  descend(mesh.levels, open, [&](std::uint32_t leaf) {
    show_leaf(mesh, leaf, measure, visitor);
    return true;
  });
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
