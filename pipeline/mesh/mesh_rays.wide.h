#pragma once

// A ray through a mesh: sixteen nodes at once in their own 16-bit units, the nearest first, and
// sixteen triangles at once. Everything is in float, and lets through what its rounding leaves in
// doubt; u is half an ulp of 1.
//
// Triangles are tested in a frame that is sheared along the ray, so that it becomes an axis, by the
// signs of the areas between it and their sides (Woop, Benthin, Wald, "Watertight ray/triangle
// intersection", JCGT 2013). It starts near the leaf, so that areas lose little.

#include "partitions/tree/traversal.wide.h"
#include "pipeline/mesh/mesh_ray_setup.wide.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// Which triangles of a leaf the line of the ray may meet, which enters the leaf at `entry`.
///
/// Coordinates of corners from there, no longer than `size`, are wrong by u of themselves, and in
/// the sheared frame, where they are at most twice as long, by less than `wrong`: by 6 u of `size`
/// and by what the ray is. The area of two such corners is wrong by less than `doubt`.
[[gnu::always_inline]] inline Mask16 on_line(const MeshView& mesh, std::uint32_t leaf,
                                             const RayJob& job, float entry) {
  constexpr float kUnit = 0x1p-24F;
  Floats from[3];
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = Floats(
        static_cast<float>(job.origin[axis] + static_cast<double>(entry) * job.direction[axis]));
  }
  Floats x[3];
  Floats y[3];
  Floats size(0.0F);
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    Floats at[3];
    load_points(mesh.vertex, mesh.corner[k] + std::size_t{leaf} * kMeshFanout, at);
    for (int axis = 0; axis < 3; ++axis) {
      at[axis] = at[axis] - from[axis];
      size = max(size, abs(at[axis]));
    }
    const auto across = [&](const float(&row)[3]) {
      return multiply_add(at[2], Floats(row[2]),
                          multiply_add(at[1], Floats(row[1]), at[0] * Floats(row[0])));
    };
    x[k] = across(job.across[0]);
    y[k] = across(job.across[1]);
  }
  const Floats wrong = multiply_add(size, Floats(8.0F * kUnit), Floats(job.wrong));
  const Floats rounded = multiply_add(size, Floats(20.0F * kUnit), wrong * Floats(8.5F));
  const Floats doubt =
      multiply_add(size, rounded, multiply_add(wrong * Floats(2.5F), wrong, Floats(1e-36F)));
  const Floats a = x[2] * y[1] - y[2] * x[1];
  const Floats b = x[0] * y[2] - y[0] * x[2];
  const Floats c = x[1] * y[0] - y[1] * x[0];
  const LaneMask<float> misses = (max(max(a, b), c) > doubt) & (min(min(a, b), c) < -doubt);
  return ~bits(misses) & 0xFFFFU;
}

/// What a ray does next: goes into a node, asks for the vertices of a leaf whose corners are there,
/// looks at its triangles.
enum RayStep : std::uint32_t { kEnterInner, kEnterLeaf, kFetchVertices, kLook, kNoStep };

/// A ray on its way: the nodes that wait for it, of which the nearest is the last of those that
/// came together. What is needed soon is asked for before: by a ray that goes alone all that may be
/// needed of a leaf, since it has nothing else to do meanwhile.
template <bool Alone>
class RayWalk {
 public:
  /// `ray`: as its visitor knows it.
  void start(const MeshView& mesh, const ReadyRays& ready, unsigned lane, std::uint32_t ray,
             double limit) {
    take_ready(ready, lane, job_);
    ray_ = ray;
    size_ = 0;
    set_limit(limit);
    // What is below a top level of few nodes is nearly as soon asked.
    constexpr std::uint32_t kFewNodes = 2;
    std::uint32_t level = mesh.levels - 1;
    if (level != 0 && mesh.count[level] <= kFewNodes) --level;
    for (std::uint32_t node = 0; node < mesh.count[level]; node += kLanes) {
      meet(mesh, level, node, 0);
    }
  }

  /// The next step, once nodes are dropped that begin behind what was met: into the nearest that
  /// waits, or none.
  [[gnu::always_inline]] RayStep next() {
    while (size_ != 0 && !(entry_of(waiting_[size_ - 1]) <= last_)) --size_;
    if (size_ == 0) return kNoStep;
    return level_of(waiting_[size_ - 1]) != 0 ? kEnterInner : kEnterLeaf;
  }
  /// Goes into that inner node.
  [[gnu::always_inline]] void enter_inner(const MeshView& mesh) {
    const std::uint64_t waiting = waiting_[--size_];
    meet(mesh, level_of(waiting) - 1, node_of(waiting) * kLanes, size_);
  }
  /// Goes to that leaf: false if none of its triangles need be looked at. Before they are, their
  /// vertices are to be fetched.
  [[gnu::always_inline]] bool enter_leaf(const MeshView& mesh) {
    const std::uint64_t waiting = waiting_[--size_];
    ask(mesh, node_of(waiting), entry_of(waiting));
    return asked_.triangles != 0;
  }
  [[gnu::always_inline]] void fetch_vertices(const MeshView& mesh) const {
    fetch_vertices(mesh, asked_);
  }
  /// Looks at them; false if the visitor has seen enough.
  bool look(const MeshView& mesh, const RaySlotVisitor& visitor) {
    return look(mesh, asked_, visitor);
  }
  /// The whole way of one ray. A leaf is looked at after the next node, while its vertices come.
  void go(const MeshView& mesh, const RaySlotVisitor& visitor) {
    asked_.triangles = 0;
    for (;;) {
      const Asked asked = asked_;
      asked_.triangles = 0;
      const RayStep step = next();
      if (step == kEnterInner) enter_inner(mesh);
      if (step == kEnterLeaf && enter_leaf(mesh)) fetch_vertices(mesh);
      if (asked.triangles != 0 && !look(mesh, asked, visitor)) return;
      if (step == kNoStep && asked.triangles == 0) return;
    }
  }

 private:
  /// A node that waits: when it is entered, as the bits of a float that is not negative, its level
  /// and its number.
  static constexpr std::uint32_t kLevelShift = 28;
  static float entry_of(std::uint64_t waiting) {
    return __builtin_bit_cast(float, static_cast<std::uint32_t>(waiting >> 32));
  }
  static std::uint32_t level_of(std::uint64_t waiting) {
    return static_cast<std::uint32_t>(waiting) >> kLevelShift;
  }
  static std::uint32_t node_of(std::uint64_t waiting) {
    return static_cast<std::uint32_t>(waiting) & ((1U << kLevelShift) - 1U);
  }
  /// A leaf that was gone to: when it is entered, and which of its triangles may be met.
  struct Asked {
    std::uint32_t leaf;
    float entry;
    Mask16 triangles;
  };

  void set_limit(double limit) {
    limit_ = limit;
    const double rest = (limit - job_.entry) * job_.pace * (1.0 + 0x1p-20);
    last_ = rest < 1e38 ? static_cast<float>(rest) : 1e38F;
  }

  /// Which of sixteen boxes, in columns from `bounds` on, the ray meets, and when it enters them.
  [[gnu::always_inline]] Mask16 enter(const std::uint16_t* bounds, Floats& in) const {
    in = Floats(0.0F);
    Floats out(last_);
    for (int axis = 0; axis < 3; ++axis) {
      const Floats inverse(job_.inverse[axis]);
      const Floats near = load_short(bounds + job_.near_bound[axis]);
      const Floats far = load_short(bounds + job_.far_bound[axis]);
      in = max(in, multiply_add(near, inverse, Floats(job_.near[axis])));
      out = min(out, multiply_add(far, inverse, Floats(job_.far[axis])));
    }
    return bits(in <= out);
  }

  /// Lets those of sixteen nodes wait that the ray meets, together with those from `together` on.
  [[gnu::always_inline]] void meet(const MeshView& mesh, std::uint32_t level,
                                   std::uint32_t first_node, std::uint32_t together) {
    Floats in;
    Mask16 hits = enter(mesh.node[level] + std::size_t{6} * first_node, in) &
                  present(mesh.count[level], first_node);
    // Zero may have a sign, which is no order of its bits.
    alignas(64) float entry[kLanes];
    abs(in).store(entry);
    for (; hits != 0; hits &= hits - 1) {
      const unsigned lane = first(hits);
      const std::uint32_t node = first_node + lane;
      if (level == 0) fetch(mesh, node);
      const std::uint64_t fresh = std::uint64_t{__builtin_bit_cast(std::uint32_t, entry[lane])}
                                      << 32 |
                                  (level << kLevelShift | node);
      std::uint32_t at = size_++;
      for (; at != together && waiting_[at - 1] < fresh; --at) waiting_[at] = waiting_[at - 1];
      waiting_[at] = fresh;
    }
  }

  static void fetch_corners(const MeshView& mesh, std::uint32_t leaf) {
    for (const std::uint32_t* const corner : mesh.corner) {
      __builtin_prefetch(corner + std::size_t{leaf} * kMeshFanout);
    }
  }

  /// Asks for what of a leaf is looked at first, before it is waited for. Of nodes there are few
  /// enough to be at hand.
  static void fetch(const MeshView& mesh, std::uint32_t leaf) {
    if (Alone || mesh.box == nullptr) fetch_corners(mesh, leaf);
    if (mesh.box == nullptr) return;
    const std::uint16_t* const box = mesh.box + std::size_t{6} * kMeshFanout * leaf;
    for (std::size_t k = 0; k < 3; ++k) __builtin_prefetch(box + 32 * k);
  }

  /// Finds out which triangles of a leaf are to be looked at: those whose boxes the ray meets where
  /// they have some.
  [[gnu::always_inline]] void ask(const MeshView& mesh, std::uint32_t leaf, float entry) {
    const std::uint32_t first_slot = leaf * kMeshFanout;
    asked_ = {leaf, entry, present(mesh.triangle_count, first_slot)};
    if (mesh.box == nullptr) return;
    Floats in;
    asked_.triangles &= enter(mesh.box + std::size_t{6} * first_slot, in);
    if (!Alone && asked_.triangles != 0) fetch_corners(mesh, leaf);
  }

  /// Asks for their vertices, once their corners are there; neighbours in a leaf without boxes
  /// share most of them.
  [[gnu::always_inline]] void fetch_vertices(const MeshView& mesh, const Asked& asked) const {
    const std::uint32_t first_slot = asked.leaf * kMeshFanout;
    Mask16 rest = mesh.box != nullptr ? asked.triangles : 1U;
    for (; rest != 0; rest &= rest - 1) {
      for (const std::uint32_t* const corner : mesh.corner) {
        __builtin_prefetch(mesh.vertex + std::size_t{3} * corner[first_slot + first(rest)]);
      }
    }
    __builtin_prefetch(mesh.triangle + first_slot);
  }

  /// False if the visitor has seen enough.
  bool look(const MeshView& mesh, const Asked& asked, const RaySlotVisitor& visitor) {
    if (!(asked.entry <= last_)) return true;
    Mask16 triangles = asked.triangles;
    if (mesh.box == nullptr) triangles &= on_line(mesh, asked.leaf, job_, asked.entry);
    if (triangles == 0) return true;
    const std::uint32_t first_slot = asked.leaf * kMeshFanout;
    std::uint32_t slots[kLanes];
    std::uint32_t count = 0;
    for (; triangles != 0; triangles &= triangles - 1) {
      slots[count++] = first_slot + first(triangles);
    }
    const double limit = visitor.visit(visitor.context, ray_, slots, count, limit_);
    if (limit != limit_) set_limit(limit);
    return limit >= 0.0;
  }

  RayJob job_;
  std::uint32_t ray_;
  double limit_;
  float last_;
  std::uint32_t size_;
  Asked asked_;
  /// One more than waits, as the nearest is among them for a moment.
  std::uint64_t waiting_[kMaxMeshLevels * kMeshFanout + 1];
};

/// Rays that have not begun their way, in their order.
class WaitingRays {
 public:
  WaitingRays(const MeshView& mesh, const MeshSpan& span, const SurfaceRays& rays,
              const double* limits, std::uint32_t count)
      : mesh_(mesh), span_(span), rays_(rays), limits_(limits), count_(count) {
    make_some_ready();
  }

  /// Lets the next one start that does not pass the mesh by; false if there is none.
  template <bool Alone>
  [[gnu::always_inline]] bool start(RayWalk<Alone>& walk) {
    while (come_ == 0) {
      first_ += kRayLanes;
      if (first_ >= count_) return false;
      make_some_ready();
    }
    const unsigned lane = first(come_);
    come_ &= come_ - 1;
    walk.start(mesh_, ready_, lane, first_ + lane, limits_[first_ + lane]);
    return true;
  }

 private:
  void make_some_ready() {
    come_ = count_ == 1 ? make_ready<true>(span_, rays_, limits_, first_, ready_)
                        : make_ready<false>(span_, rays_, limits_, first_, ready_);
    if (count_ - first_ < kRayLanes) come_ &= lanes_below(count_ - first_);
  }

  const MeshView& mesh_;
  const MeshSpan& span_;
  const SurfaceRays& rays_;
  const double* limits_;
  std::uint32_t count_;
  std::uint32_t first_ = 0;
  Mask16 come_;
  ReadyRays ready_;
};

/// Rays that go through a mesh side by side, so that none waits for memory. In each round all take
/// the same kind of step one after the other, so that the processor foresees which.
class RaysSideBySide {
 public:
  RaysSideBySide(const MeshView& mesh, const RaySlotVisitor& visitor, WaitingRays& waiting)
      : mesh_(mesh), visitor_(visitor), waiting_(waiting) {}

  void run() {
    std::uint32_t begun = 0;
    while (begun < kWalks && waiting_.start(walk_[begun])) sort_in(begun++);
    const RayStep first_step = mesh_.box != nullptr ? kFetchVertices : kLook;
    while (waits()) {
      each(kLook, [&](std::uint32_t i) {
        if (walk_[i].look(mesh_, visitor_) || waiting_.start(walk_[i])) sort_in(i);
      });
      each(kFetchVertices, [&](std::uint32_t i) {
        walk_[i].fetch_vertices(mesh_);
        waits_[kLook].put(i);
      });
      each(kEnterLeaf, [&](std::uint32_t i) {
        if (!walk_[i].enter_leaf(mesh_)) return sort_in(i);
        if (first_step == kLook) walk_[i].fetch_vertices(mesh_);
        waits_[first_step].put(i);
      });
      each(kEnterInner, [&](std::uint32_t i) {
        walk_[i].enter_inner(mesh_);
        sort_in(i);
      });
    }
  }

 private:
  static constexpr std::uint32_t kWalks = 32;
  /// Rays that wait for the same kind of step.
  struct Waits {
    std::uint32_t count = 0;
    std::uint32_t ray[kWalks] = {};

    [[gnu::always_inline]] void put(std::uint32_t i) { ray[count++] = i; }
  };

  [[nodiscard]] bool waits() const {
    std::uint32_t sum = 0;
    for (const Waits& one : waits_) sum += one.count;
    return sum != 0;
  }
  /// Lets a ray wait for its next step; or the one after it that has not begun, if it has come to
  /// its end.
  [[gnu::always_inline]] void sort_in(std::uint32_t i) {
    RayStep next = walk_[i].next();
    while (next == kNoStep) {
      if (!waiting_.start(walk_[i])) return;
      next = walk_[i].next();
    }
    waits_[next].put(i);
  }
  /// Takes all that wait for this kind of step now.
  template <typename Step>
  [[gnu::always_inline]] void each(RayStep kind, Step&& step) {
    const Waits now = waits_[kind];
    waits_[kind].count = 0;
    for (std::uint32_t k = 0; k < now.count; ++k) step(now.ray[k]);
  }

  const MeshView& mesh_;
  const RaySlotVisitor& visitor_;
  WaitingRays& waiting_;
  Waits waits_[kNoStep];
  RayWalk<false> walk_[kWalks];
};

/// Shows the triangles that each ray may meet, its nearest leaf first.
inline void show_on_rays(const MeshView& mesh, const MeshSpan& span, const SurfaceRays& rays,
                         const double* limits, std::uint32_t count, const RaySlotVisitor& visitor) {
  WaitingRays waiting(mesh, span, rays, limits, count);
  if (count == 1) {
    RayWalk<true> walk;
    if (waiting.start(walk)) walk.go(mesh, visitor);
    return;
  }
  RaysSideBySide(mesh, visitor, waiting).run();
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
