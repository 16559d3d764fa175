#pragma once

// Walks that come upon triangles roughly in the order of a measure: the time at which a moving box
// meets theirs, or the squared distance from it. Boxes are measured in double.

#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_traversals.kernel.h"

namespace winnow::WINNOW_ISA_NAME {

/// More than the relative error of the few operations that make a measure.
inline constexpr double kMeasureError = 0x1p-48;

/// When the moving box first meets boxes; above `limit` where it does not by then.
class SweepMeasure {
 public:
  SweepMeasure(const MeshSweepJob& job, double limit) : job_(job), limit_(limit) {}

  void set_limit(double limit) { limit_ = limit; }
  [[nodiscard]] double limit() const { return limit_; }

  [[gnu::always_inline]] Double8 operator()(const Box8& box) const {
    Double8 entry(0.0);
    Double8 exit(limit_);
    Truth<double> met = entry <= entry;
    for (int axis = 0; axis < 3; ++axis) {
      const Double8 near = box.low[axis] - Double8(job_.max[axis]);
      const Double8 far = box.high[axis] - Double8(job_.min[axis]);
      if (job_.is_static[axis]) {
        met = met & (near <= Double8(0.0)) & (far >= Double8(0.0));
        continue;
      }
      const Double8 inverse(job_.inverse[axis]);
      const Double8 a = near * inverse;
      const Double8 b = far * inverse;
      entry = max(entry, min(a, b) * Double8(1.0 - kMeasureError));
      exit = min(exit, max(a, b) * Double8(1.0 + kMeasureError));
    }
    return select(met & (entry <= exit), entry, Double8(__builtin_inf()));
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

  [[gnu::always_inline]] Double8 operator()(const Box8& box) const {
    Double8 square(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      const Double8 scale(job_.scale[axis]);
      const Double8 a = box.low[axis] * scale;
      const Double8 b = box.high[axis] * scale;
      const Double8 error = max(abs(a), abs(b)) * Double8(0x1p-50);
      const Double8 below = Double8(job_.min[axis]) - (max(a, b) + error);
      const Double8 above = (min(a, b) - error) - Double8(job_.max[axis]);
      const Double8 gap = max(Double8(0.0), max(below, above));
      square += gap * gap;
    }
    return square * Double8(1.0 - kMeasureError);
  }
  [[nodiscard]] bool within(double measure) const { return measure <= square_; }

 private:
  const MeshNearJob& job_;
  double limit_ = 0.0;
  double square_ = 0.0;
};

/// Lanes of a block that are within the limit, the nearest first.
struct OrderedLanes {
  double measure[kLanes];
  std::uint32_t lane[kLanes];
  std::uint32_t count = 0;
};

template <typename Measure>
inline void order_lanes(const Measure& measure, const Box8& low, const Box8& high, Mask16 lanes,
                        OrderedLanes& out) {
  alignas(64) double value[kLanes];
  measure(low).store(value);
  measure(high).store(value + 8);
  out.count = 0;
  for (; lanes != 0; lanes &= lanes - 1) {
    const unsigned lane = first(lanes);
    if (!measure.within(value[lane])) continue;
    std::uint32_t at = out.count++;
    for (; at != 0 && out.measure[at - 1] > value[lane]; --at) {
      out.measure[at] = out.measure[at - 1];
      out.lane[at] = out.lane[at - 1];
    }
    out.measure[at] = value[lane];
    out.lane[at] = lane;
  }
}

struct WaitingNode {
  double measure;
  std::uint32_t node;
  std::uint32_t level;
};

/// Shows a leaf's triangles within the limit.
template <typename Measure>
inline void show_leaf(const MeshView& mesh, std::uint32_t leaf, Measure& measure,
                      const SlotVisitor& visitor) {
  const Box16 box = box_of(load_corners(mesh, leaf));
  const std::uint32_t first_slot = leaf * kMeshFanout;
  OrderedLanes found;
  order_lanes(measure, in_double<0>(box), in_double<1>(box),
              present(mesh.triangle_count, first_slot), found);
  if (found.count == 0) return;
  for (std::uint32_t i = 0; i < found.count; ++i) found.lane[i] += first_slot;
  measure.set_limit(visitor.visit(visitor.context, found.lane, found.count, measure.limit()));
}

/// Depth first, the nearest child first. Every level leaves at most 15 nodes waiting while one is
/// descended into, which bounds the stack.
template <typename Measure>
inline void walk_in_order(const MeshView& mesh, Measure& measure, const SlotVisitor& visitor) {
  WaitingNode waiting[kMaxMeshLevels * kMeshFanout];
  std::uint32_t size = 0;
  const auto open = [&](std::uint32_t level, std::uint32_t first_node) {
    const Box16 nodes = load_nodes(mesh, level, first_node);
    Box8 low = in_double<0>(nodes);
    Box8 high = in_double<1>(nodes);
    decode(mesh, low);
    decode(mesh, high);
    OrderedLanes found;
    order_lanes(measure, low, high, present(mesh.count[level], first_node), found);
    for (std::uint32_t i = found.count; i-- > 0;) {
      waiting[size++] = {found.measure[i], first_node + found.lane[i], level};
    }
  };
  open(mesh.levels - 1, 0);
  while (size != 0 && measure.limit() >= 0.0) {
    const WaitingNode next = waiting[--size];
    if (!measure.within(next.measure)) continue;
    if (next.level == 0) {
      show_leaf(mesh, next.node, measure, visitor);
    } else {
      open(next.level - 1, next.node * kMeshFanout);
    }
  }
}

}  // namespace winnow::WINNOW_ISA_NAME
