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

/// The open nodes of a ray, of which the nearest is the last; see OpenMeshNodes.
class OpenRayNodes {
 public:
  OpenRayNodes(const MeshView& mesh, const MeshRayJob& job, double limit) : mesh_(mesh), job_(job) {
    set_limit(limit);
  }

  [[nodiscard]] double limit() const { return limit_; }
  void set_limit(double limit) {
    limit_ = limit;
    const double rest = (limit - job_.entry) * job_.pace * (1.0 + 0x1p-20);
    last_ = rest < 1e38 ? static_cast<float>(rest) : 1e38F;
  }
  /// When the ray enters the node that is visited.
  [[nodiscard]] float entry() const { return entry_; }

  bool open(std::uint32_t level, std::uint32_t first_node, std::uint32_t& node) {
    const std::uint16_t* const bounds = mesh_.node[level] + std::size_t{6} * first_node;
    Floats in(0.0F);
    Floats out(last_);
    for (int axis = 0; axis < 3; ++axis) {
      const Floats inverse(job_.inverse[axis]);
      const Floats near = load_short(bounds + job_.near_bound[axis]);
      const Floats far = load_short(bounds + job_.far_bound[axis]);
      in = max(in, multiply_add(near, inverse, Floats(job_.near[axis])));
      out = min(out, multiply_add(far, inverse, Floats(job_.far[axis])));
    }
    Mask16 hits = bits(in <= out) & present(mesh_.count[level], first_node);
    if (hits == 0) return false;
    alignas(64) float entry[kLanes];
    in.store(entry);
    const std::uint32_t before = size_;
    for (; hits != 0; hits &= hits - 1) {
      const unsigned lane = first(hits);
      if (level == 0) fetch_corners(first_node + lane);
      std::uint32_t at = size_++;
      for (; at != before && waiting_[at - 1].entry < entry[lane]; --at) {
        waiting_[at] = waiting_[at - 1];
      }
      waiting_[at] = {entry[lane], first_node + lane, level};
    }
    node = waiting_[--size_].node;
    entry_ = waiting_[size_].entry;
    return true;
  }

  bool take(std::uint32_t& level, std::uint32_t& node) {
    while (size_ != 0) {
      const Waiting& next = waiting_[--size_];
      if (!(next.entry <= last_)) continue;
      level = next.level;
      node = next.node;
      entry_ = next.entry;
      return true;
    }
    return false;
  }

 private:
  /// Asks for what a leaf is made of, before it is waited for.
  void fetch_corners(std::uint32_t leaf) const {
    const std::size_t slot = std::size_t{leaf} * kMeshFanout;
    for (int k = 0; k < 3; ++k) __builtin_prefetch(mesh_.corner[k] + slot);
  }

  struct Waiting {
    float entry;
    std::uint32_t node;
    std::uint32_t level;
  };

  const MeshView& mesh_;
  const MeshRayJob& job_;
  double limit_ = 0.0;
  float last_ = 0.0F;
  float entry_ = 0.0F;
  std::uint32_t size_ = 0;
  /// One more than waits, as the nearest is among them for a moment.
  Waiting waiting_[kMaxMeshLevels * kMeshFanout + 1];
};

/// Which triangles of a leaf the line of the ray may meet.
///
/// In the sheared frame a corner (x, y) is wrong by less than `ex` in x: by 4 u of the coordinates
/// along the ray and 2 u of x, as differences, the shear and its product are rounded, and by what
/// the ray itself is. The area of two such corners is wrong by less than `doubt`.
template <int Z>
[[gnu::always_inline]] inline Mask16 on_line(const Corners16& corners, const MeshRayJob& job,
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

template <int Z>
inline void show_on_ray_along(const MeshView& mesh, const MeshRayJob& job, double limit,
                              const SlotVisitor& visitor) {
  OpenRayNodes open(mesh, job, limit);
  descend(mesh.levels, open, [&](std::uint32_t leaf) {
    const std::uint32_t first_slot = leaf * kMeshFanout;
    Mask16 hits = on_line<Z>(load_corners(mesh, leaf), job, open.entry()) &
                  present(mesh.triangle_count, first_slot);
    if (hits == 0) return true;
    __builtin_prefetch(mesh.triangle + first_slot);
    std::uint32_t slots[kLanes];
    std::uint32_t count = 0;
    for (; hits != 0; hits &= hits - 1) slots[count++] = first_slot + first(hits);
    open.set_limit(visitor.visit(visitor.context, slots, count, open.limit()));
    return open.limit() >= 0.0;
  });
}

/// Shows the triangles that the ray may meet, the nearest leaf first.
inline void show_on_ray(const MeshView& mesh, const MeshRayJob& job, double limit,
                        const SlotVisitor& visitor) {
  if (job.fastest == 0) {
    show_on_ray_along<0>(mesh, job, limit, visitor);
  } else if (job.fastest == 1) {
    show_on_ray_along<1>(mesh, job, limit, visitor);
  } else {
    show_on_ray_along<2>(mesh, job, limit, visitor);
  }
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
