#pragma once

// A ray through a mesh: sixteen nodes at once in their own 16-bit units, the nearest first, and
// sixteen triangles at once. Everything is in float, and lets through what its rounding leaves in
// doubt; u is half an ulp of 1.
//
// Triangles are tested in a frame that is sheared along the ray, so that it becomes an axis, by the
// signs of the areas between it and their sides (Woop, Benthin, Wald, "Watertight ray/triangle
// intersection", JCGT 2013). It starts near the leaf, so that areas lose little.

#include "partitions/tree/traversal.wide.h"
#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_traversal.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// Which triangles of a leaf the line of the ray may meet.
///
/// In the sheared frame a corner (x, y) is wrong by less than `ex` in x: by 4 u of the coordinates
/// along the ray and 2 u of x, as differences, the shear and its product are rounded, and by what
/// the ray itself is. The area of two such corners is wrong by less than `doubt`.
template <int Z>
[[gnu::always_inline]] inline Mask16 on_line_along(const Corners16& corners, const MeshRayJob& job,
                                                   float entry) {
  constexpr float kUnit = 0x1p-24F;
  constexpr int X = (Z + 1) % 3;
  constexpr int Y = (Z + 2) % 3;
  float from[3];
  float farthest = 0.0F;
  for (int axis = 0; axis < 3; ++axis) {
    const double at = job.origin[axis] + static_cast<double>(entry) * job.direction[axis];
    from[axis] = static_cast<float>(at);
    const float size = from[axis] < 0.0F ? -from[axis] : from[axis];
    farthest = size > farthest ? size : farthest;
  }
  Floats x[3];
  Floats y[3];
  Floats depth(0.0F);
  Floats most_x(0.0F);
  Floats most_y(0.0F);
  for (int k = 0; k < 3; ++k) {
    const auto& corner = corners.at[k];
    const Floats z = corner[Z] - Floats(from[Z]);
    x[k] = (corner[X] - Floats(from[X])) - z * Floats(job.shear[0]);
    y[k] = (corner[Y] - Floats(from[Y])) - z * Floats(job.shear[1]);
    depth = max(depth, abs(z));
    most_x = max(most_x, abs(x[k]));
    most_y = max(most_y, abs(y[k]));
  }
  const Floats moved = Floats(4.0F * (job.slack + farthest * 2.0F * kUnit)) +
                       depth * Floats(8.0F * kUnit) + Floats(1e-36F);
  const Floats ex = moved + most_x * Floats(4.0F * kUnit);
  const Floats ey = moved + most_y * Floats(4.0F * kUnit);
  const Floats doubt = Floats(2.5F) * (ex * (most_y + ey) + ey * most_x) +
                       Floats(8.0F * kUnit) * most_x * most_y + Floats(1e-36F);
  const Floats a = x[2] * y[1] - y[2] * x[1];
  const Floats b = x[0] * y[2] - y[0] * x[2];
  const Floats c = x[1] * y[0] - y[1] * x[0];
  const LaneMask<float> misses = (max(max(a, b), c) > doubt) & (min(min(a, b), c) < -doubt);
  return ~bits(misses) & 0xFFFFU;
}

[[gnu::always_inline]] inline Mask16 on_line(const Corners16& corners, const MeshRayJob& job,
                                             float entry) {
  if (job.fastest == 0) return on_line_along<0>(corners, job, entry);
  return job.fastest == 1 ? on_line_along<1>(corners, job, entry)
                          : on_line_along<2>(corners, job, entry);
}

/// A ray on its way: the nodes that wait for it, of which the nearest is the last of those that
/// came together.
class RayWalk {
 public:
  void start(const MeshView& mesh, const MeshRayJob& job) {
    job_ = &job;
    size_ = 0;
    set_limit(job.limit);
    // What is below a top level of few nodes is nearly as soon asked.
    constexpr std::uint32_t kFewNodes = 2;
    std::uint32_t level = mesh.levels - 1;
    if (level != 0 && mesh.count[level] <= kFewNodes) --level;
    for (std::uint32_t node = 0; node < mesh.count[level]; node += kLanes) {
      meet(mesh, level, node, 0);
    }
  }

  /// Goes on with the nearest node that waits; false if the ray has come to its end.
  bool step(const MeshView& mesh, const RaySlotVisitor& visitor) {
    while (size_ != 0) {
      const std::uint64_t next = waiting_[--size_];
      const float entry = entry_of(next);
      if (!(entry <= last_)) continue;
      const auto place = static_cast<std::uint32_t>(next);
      const std::uint32_t level = place >> kLevelShift;
      const std::uint32_t node = place & ((1U << kLevelShift) - 1U);
      if (level == kSlots) return show(&node, 1, visitor);
      if (level == 0 && mesh.box == nullptr) return show_leaf(mesh, node, entry, visitor);
      meet(mesh, level == 0 ? kSlots : level - 1, node * kLanes, size_);
      return true;
    }
    return false;
  }

 private:
  /// A node that waits: when it is entered, as the bits of a float that is not negative, its level
  /// and its number.
  static constexpr std::uint32_t kLevelShift = 28;
  /// In the place of the level where the number is that of a triangle's slot.
  static constexpr std::uint32_t kSlots = kMaxMeshLevels;
  static float entry_of(std::uint64_t waiting) {
    return __builtin_bit_cast(float, static_cast<std::uint32_t>(waiting >> 32));
  }

  void set_limit(double limit) {
    limit_ = limit;
    const double rest = (limit - job_->entry) * job_->pace * (1.0 + 0x1p-20);
    last_ = rest < 1e38 ? static_cast<float>(rest) : 1e38F;
  }

  /// Lets those of sixteen nodes, or triangles, wait that the ray meets, together with those from
  /// `together` on.
  [[gnu::always_inline]] void meet(const MeshView& mesh, std::uint32_t level,
                                   std::uint32_t first_node, std::uint32_t together) {
    const bool are_slots = level == kSlots;
    const std::uint16_t* const bounds =
        (are_slots ? mesh.box : mesh.node[level]) + std::size_t{6} * first_node;
    Floats in(0.0F);
    Floats out(last_);
    for (int axis = 0; axis < 3; ++axis) {
      const Floats inverse(job_->inverse[axis]);
      const Floats near = load_short(bounds + job_->near_bound[axis]);
      const Floats far = load_short(bounds + job_->far_bound[axis]);
      in = max(in, multiply_add(near, inverse, Floats(job_->near[axis])));
      out = min(out, multiply_add(far, inverse, Floats(job_->far[axis])));
    }
    Mask16 hits =
        bits(in <= out) & present(are_slots ? mesh.triangle_count : mesh.count[level], first_node);
    // Zero may have a sign, which is no order of its bits.
    alignas(64) float entry[kLanes];
    abs(in).store(entry);
    for (; hits != 0; hits &= hits - 1) {
      const unsigned lane = first(hits);
      const std::uint32_t node = first_node + lane;
      fetch(mesh, level, node);
      const std::uint64_t fresh = std::uint64_t{__builtin_bit_cast(std::uint32_t, entry[lane])}
                                      << 32 |
                                  (level << kLevelShift | node);
      std::uint32_t at = size_++;
      for (; at != together && waiting_[at - 1] < fresh; --at) waiting_[at] = waiting_[at - 1];
      waiting_[at] = fresh;
    }
  }

  /// Asks for what leaves and triangles are made of, before it is waited for. Of nodes there are
  /// few enough to be at hand.
  static void fetch(const MeshView& mesh, std::uint32_t level, std::uint32_t node) {
    if (level != 0 && level != kSlots) return;
    const std::size_t slot = level == kSlots ? node : std::size_t{node} * kMeshFanout;
    const bool has_boxes = level == 0 && mesh.box != nullptr;
    for (std::size_t k = 0; k < 3; ++k) {
      __builtin_prefetch(has_boxes ? static_cast<const void*>(mesh.box + 6 * slot + 32 * k)
                                   : mesh.corner[k] + slot);
    }
  }

  /// False if the visitor has seen enough.
  bool show_leaf(const MeshView& mesh, std::uint32_t leaf, float entry,
                 const RaySlotVisitor& visitor) {
    const std::uint32_t first_slot = leaf * kMeshFanout;
    Mask16 hits =
        on_line(load_corners(mesh, leaf), *job_, entry) & present(mesh.triangle_count, first_slot);
    if (hits == 0) return true;
    __builtin_prefetch(mesh.triangle + first_slot);
    std::uint32_t slots[kLanes];
    std::uint32_t count = 0;
    for (; hits != 0; hits &= hits - 1) slots[count++] = first_slot + first(hits);
    return show(slots, count, visitor);
  }

  bool show(const std::uint32_t* slots, std::uint32_t count, const RaySlotVisitor& visitor) {
    const double limit = visitor.visit(visitor.context, job_->ray, slots, count, limit_);
    if (limit != limit_) set_limit(limit);
    return limit >= 0.0;
  }

  const MeshRayJob* job_;
  double limit_;
  float last_;
  std::uint32_t size_;
  /// One more than waits, as the nearest is among them for a moment.
  std::uint64_t waiting_[(kMaxMeshLevels + 1) * kMeshFanout + 1];
};

/// Shows the triangles that each ray may meet, its nearest leaf first. The rays take turns, so that
/// none waits for memory, nor for what the processor finds out last, while others could go on.
inline void show_on_rays(const MeshView& mesh, const MeshRayJob* jobs, std::uint32_t count,
                         const RaySlotVisitor& visitor) {
  RayWalk walk[kRaysAtOnce];
  std::uint32_t turn[kRaysAtOnce];
  for (std::uint32_t i = 0; i < count; ++i) {
    walk[i].start(mesh, jobs[i]);
    turn[i] = i;
  }
  while (count != 0) {
    for (std::uint32_t i = 0; i < count;) {
      if (walk[turn[i]].step(mesh, visitor)) {
        ++i;
      } else {
        turn[i] = turn[--count];
      }
    }
  }
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
