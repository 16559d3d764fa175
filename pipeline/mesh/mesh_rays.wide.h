#pragma once

// A ray through a mesh: sixteen nodes at once in their own 16-bit units, the nearest first, and
// sixteen triangles at once. Everything is in float, and lets through what its rounding leaves in
// doubt; u is half an ulp of 1.
//
// Triangles are tested in a frame that is sheared along the ray, so that it becomes an axis, by the
// signs of the areas between it and their sides (Woop, Benthin, Wald, "Watertight ray/triangle
// intersection", JCGT 2013); in units of the nodes too, and by where their vertices are in the box
// of their leaf, of which each takes four bytes.

#include "partitions/tree/traversal.wide.h"
#include "pipeline/mesh/mesh_crossing.wide.h"
#include "pipeline/mesh/mesh_ray_setup.wide.h"
#include "simd/lanes/packed.h"
#include "simd/lanes/positive.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// Corners of triangles across a ray: where they are along two axes once they are moved along the
/// ray to one place on the third, the fastest one, measured from the ray.
struct CornersAcross {
  Floats x[3];
  Floats y[3];
};

/// Which of those triangles the line of the ray may meet, if coordinates are wrong by less than
/// `wrong`, less 0.05 units for roundings of products, of 6 u of a coordinate of 2^17.
///
/// The product of two corners is wrong by less than `wrong` times the coordinates of both and twice
/// its square.
[[gnu::always_inline]] inline Mask16 around_line(const CornersAcross& at, float wrong) {
  const auto taxicab = [&](int k) { return abs(at.x[k]) + abs(at.y[k]); };
  const Floats doubt = multiply_add(taxicab(0) + taxicab(1) + taxicab(2), Floats(wrong),
                                    Floats(2.1F * wrong * wrong));
  const Floats a = at.x[2] * at.y[1] - at.y[2] * at.x[1];
  const Floats b = at.x[0] * at.y[2] - at.y[0] * at.x[2];
  const Floats c = at.x[1] * at.y[0] - at.y[1] * at.x[0];
  const LaneMask<float> misses = (max(max(a, b), c) > doubt) & (min(min(a, b), c) < -doubt);
  return ~bits(misses) & 0xFFFFU;
}

/// The line of a ray, in units.
class RayLine {
 public:
  template <std::uint32_t Room>
  [[gnu::always_inline]] void set(const ReadyRays<Room>& rays, std::uint32_t ray) {
    constexpr std::uint32_t kNext[3] = {1, 2, 0};
    const auto size = [&](std::uint32_t axis) { return __builtin_fabsf(rays.inverse[axis][ray]); };
    const std::uint32_t faster = size(1) < size(0) ? 1 : 0;
    const std::uint32_t fastest = size(2) < size(faster) ? 2 : faster;
    const std::uint32_t side[2] = {kNext[fastest], kNext[kNext[fastest]]};
    float wrong[2];
    for (std::uint32_t k = 0; k < 2; ++k) {
      const std::uint32_t axis = side[k];
      const float slope = -rays.inverse[fastest][ray] / rays.inverse[axis][ray];
      across_[k][fastest] = slope;
      across_[k][axis] = 1.0F;
      across_[k][side[1 - k]] = 0.0F;
      at_[k] = rays.at[axis][ray] + slope * rays.at[fastest][ray];
      wrong[k] = rays.grow[axis][ray] + __builtin_fabsf(slope) * rays.grow[fastest][ray];
    }
    wrong_ = larger(wrong[0], wrong[1]) + kRoundings;
  }

  /// Which triangles of a leaf it may meet.
  [[gnu::always_inline]] Mask16 near(const MeshView& mesh, std::uint32_t leaf) const {
    const int blocks = mesh.leaf_point != nullptr ? vertex_blocks(mesh, leaf) : 0;
    if (blocks == 1) return near_listed<1>(mesh, leaf);
    if (blocks == 2) return near_listed<2>(mesh, leaf);
    return near_corners(mesh, leaf);
  }

 private:
  /// For those of coordinates from here on, of 65536 units or their products.
  static constexpr float kRoundings = 0.12F;

  [[gnu::always_inline]] static float larger(float a, float b) { return a > b ? a : b; }

  /// By way of the vertices that the leaf lists, which are wrong by half a step each.
  template <int Blocks>
  [[gnu::always_inline]] Mask16 near_listed(const MeshView& mesh, std::uint32_t leaf) const {
    const std::uint16_t* const bounds = mesh.node[0] + place_of_bound(leaf, 0);
    float row[2][3];
    float from[2] = {-at_[0], -at_[1]};
    float steps[2] = {0.0F, 0.0F};
    for (int axis = 0; axis < 3; ++axis) {
      const auto low = static_cast<float>(bounds[axis * kLanes]);
      const auto high = static_cast<float>(bounds[(3 + axis) * kLanes]);
      const float step = (high - low) * (1.0F / kMaxLeafPoint);
      for (int k = 0; k < 2; ++k) {
        row[k][axis] = across_[k][axis] * step;
        from[k] += across_[k][axis] * low;
        steps[k] += __builtin_fabsf(row[k][axis]);
      }
    }
    Floats x[Blocks];
    Floats y[Blocks];
    for (int block = 0; block < Blocks; ++block) {
      Floats point[3];
      load_packed(mesh.leaf_point + block_of(mesh, leaf, block) * kMeshFanout, point);
      x[block] = along(row[0], point, from[0]);
      y[block] = along(row[1], point, from[1]);
    }
    CornersAcross at;
    for (std::size_t k = 0; k < 3; ++k) {
      const LanePlaces places(places_of(mesh, leaf, k));
      at.x[k] = places.pick(x);
      at.y[k] = places.pick(y);
    }
    return around_line(at, wrong_ + 0.51F * larger(steps[0], steps[1]));
  }

  /// By way of each corner's own vertex.
  [[gnu::always_inline]] Mask16 near_corners(const MeshView& mesh, std::uint32_t leaf) const {
    CornersAcross at;
    for (std::size_t k = 0; k < 3; ++k) {
      Floats corner[3];
      load_corners(mesh, leaf, k, corner);
      for (int axis = 0; axis < 3; ++axis) {
        corner[axis] =
            (corner[axis] - Floats(mesh.origin[axis])) * Floats(mesh.span.float_units[axis]);
      }
      at.x[k] = along(across_[0], corner, -at_[0]);
      at.y[k] = along(across_[1], corner, -at_[1]);
    }
    return around_line(at, wrong_);
  }

  [[gnu::always_inline]] static Floats along(const float* row, const Floats (&at)[3], float from) {
    return multiply_add(
        at[0], Floats(row[0]),
        multiply_add(at[1], Floats(row[1]), multiply_add(at[2], Floats(row[2]), Floats(from))));
  }

  /// Rows that take a vector across it, and where it is across itself.
  float across_[2][3];
  float at_[2];
  float wrong_;
};

/// What a ray does next: goes into a node, asks for the vertices of a leaf whose corners are there,
/// finds out which of its triangles its line may meet, looks whether it does, turns to the nodes
/// that wait, or has come to its end.
enum RayStep : std::uint32_t {
  kEnterInner,
  kEnterLeaf,
  kFetchVertices,
  kFindTriangles,
  kCrossTriangles,
  kTakeNext,
  kEnd,
  kRaySteps
};

/// A ray on its way: the nodes that wait for it, of which it goes to the nearest of those that came
/// last. What is needed soon is asked for before: by a ray that goes alone all that may be needed
/// of a leaf, since it has nothing else to do meanwhile.
template <bool Alone>
class RayWalk {
 public:
  static constexpr std::uint32_t kRoom = Alone ? 1 : kRaysAtOnce;

  /// `ray`: its place among those that are ready, and as its visitor knows it. Gives its first
  /// step.
  RayStep start(const MeshView& mesh, const SurfaceRayColumns<kRoom>& own,
                const ReadyRays<kRoom>& rays, std::uint32_t ray, double limit) {
    own_ = &own;
    rays_ = &rays;
    ray_ = ray;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t upper = __builtin_bit_cast(std::uint32_t, rays.inverse[axis][ray]) >> 31U;
      near_bound_[axis] = (axis + 3U * upper) * kMeshFanout;
      far_bound_[axis] = (axis + 3U - 3U * upper) * kMeshFanout;
    }
    if (mesh.box == nullptr) line_.set(rays, ray);
    set_limit(limit);
    size_ = 0;
    // What is below a top level of few nodes is nearly as soon asked.
    const std::uint32_t top = mesh.levels - 1;
    if (top != 0 && mesh.count[top] == 2) return start_between_two(mesh, top - 1);
    const std::uint32_t level = top != 0 && mesh.count[top] == 1 ? top - 1 : top;
    return meet(mesh, level, 0) ? step_into(level << kLevelShift) : kTakeNext;
  }

  /// Turns to the nearest of the nodes that came last; or drops those that are left of them, if it
  /// begins behind what was met. Which it is, is as hard to foresee as a coin.
  [[gnu::always_inline]] RayStep take_next() {
    if (size_ == 0) return kEnd;
    const std::uint32_t at = size_ - 1;
    const std::uint32_t key = nearest(at);
    const bool is_before = aim(key, first_node_[at]);
    if (Alone && !is_before) {
      --size_;
      return kTakeNext;
    }
    const bool is_last = (rest_[at] & (rest_[at] - 1)) == 0;
    gone_to_[at] = __builtin_bit_cast(float, key);
    rest_[at] &= ~(1U << key % kLanes);
    size_ -= is_last || !is_before ? 1U : 0U;
    return is_before ? step_into(first_node_[at]) : kTakeNext;
  }
  /// Goes into that inner node, and gives the step after.
  [[gnu::always_inline]] RayStep enter_inner(const MeshView& mesh) {
    const std::uint32_t level = (node_ >> kLevelShift) - 1;
    const bool is_met = meet(mesh, level, (node_ & kNodeMask) * kLanes);
    return is_met ? step_into(level << kLevelShift) : kTakeNext;
  }
  /// Goes to that leaf: false if none of its triangles need be looked at. Before they are, their
  /// vertices are to be fetched.
  [[gnu::always_inline]] bool enter_leaf(const MeshView& mesh) {
    ask(mesh, node_, entry_);
    return asked_.triangles != 0;
  }
  /// Asks for what of that leaf is looked at first, before it is waited for. Of nodes there are few
  /// enough to be at hand.
  [[gnu::always_inline]] void fetch_leaf(const MeshView& mesh) const { fetch(mesh, node_); }
  [[gnu::always_inline]] void fetch_vertices(const MeshView& mesh) const {
    fetch_vertices(mesh, asked_);
  }
  /// False if its line meets none of them.
  [[gnu::always_inline]] bool find_triangles(const MeshView& mesh) {
    asked_.triangles &= line_.near(mesh, asked_.leaf);
    return asked_.triangles != 0;
  }
  /// False if the visitor has seen enough.
  bool cross_triangles(const MeshView& mesh, const RaySlotVisitor& visitor) {
    return cross_triangles(mesh, asked_, visitor);
  }
  /// The whole way of one ray. A leaf whose triangles have boxes is looked at after the next nodes,
  /// while its vertices come; of others nearly all is at hand.
  void go(const MeshView& mesh, RayStep step, const RaySlotVisitor& visitor) {
    asked_.triangles = 0;
    for (;;) {
      while (step == kEnterInner || step == kTakeNext) {
        step = step == kEnterInner ? enter_inner(mesh) : take_next();
      }
      if (mesh.box == nullptr) {
        if (step == kEnd) return;
        step = kTakeNext;
        if (mesh.leaf_vertex != nullptr) fetch_some_vertices(mesh, node_);
        if (enter_leaf(mesh) && find_triangles(mesh) && !cross_triangles(mesh, visitor)) return;
        continue;
      }
      const Asked asked = asked_;
      asked_.triangles = 0;
      if (step == kEnterLeaf && enter_leaf(mesh)) fetch_vertices(mesh);
      if (asked.triangles != 0 && asked.entry <= last_ && !cross_triangles(mesh, asked, visitor)) {
        return;
      }
      if (step == kEnd && asked_.triangles == 0) return;
      step = kTakeNext;
    }
  }

 private:
  /// Above the number of a node is its level.
  static constexpr std::uint32_t kLevelShift = 28;
  static constexpr std::uint32_t kNodeMask = (1U << kLevelShift) - 1U;
  static constexpr float kLeastTau = 0x1p-100F;
  static constexpr float kMostTau = 1e38F;
  /// The key of a node that does not wait: more than kMostTau.
  static constexpr float kNobody = __FLT_MAX__;

  /// A leaf that was gone to: when it is entered, and which of its triangles may be met.
  struct Asked {
    std::uint32_t leaf;
    float entry;
    Mask16 triangles;
  };

  void set_limit(double limit) {
    limit_ = limit;
    const double rest = (limit - rays_->entry[ray_]) * rays_->pace[ray_] * (1.0 + 0x1p-20);
    const float most = rest < 1e38 ? static_cast<float>(rest) : kMostTau;
    last_ = most > kLeastTau ? most : kLeastTau;
  }

  /// Which of sixteen boxes, in columns from `bounds` on, the ray meets, and when it enters them.
  [[gnu::always_inline]] LaneMask<float> enter(const std::uint16_t* bounds, Floats& in) const {
    in = Floats(kLeastTau);
    Floats out(last_);
    for (int axis = 0; axis < 3; ++axis) {
      const Floats inverse(rays_->inverse[axis][ray_]);
      const Floats near = load_short(bounds + near_bound_[axis]);
      const Floats far = load_short(bounds + far_bound_[axis]);
      in = larger_positive(in, multiply_add(near, inverse, Floats(rays_->near[axis][ray_])));
      out = smaller_positive(out, multiply_add(far, inverse, Floats(rays_->far[axis][ray_])));
    }
    return in <= out;
  }

  /// Which of sixteen nodes the ray meets, and their keys.
  [[gnu::always_inline]] Mask16 find(const MeshView& mesh, std::uint32_t level,
                                     std::uint32_t first_node, Floats& key) {
    alignas(64) static constexpr std::uint32_t kNumbers[kLanes] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                                   8, 9, 10, 11, 12, 13, 14, 15};
    Floats in;
    const LaneMask<float> met = enter(mesh.node[level] + std::size_t{6} * first_node, in);
    const Floats number = Floats::load(reinterpret_cast<const float*>(kNumbers));
    const Floats without_number(__builtin_bit_cast(float, ~(kLanes - 1U)));
    key = select(met, (in & without_number) | number, Floats(kNobody));
    const Mask16 all = bits(met);
    const Mask16 hits = all & present(mesh.count[level], first_node);
    if (hits != all) [[unlikely]] {
      alignas(64) float one[kLanes];
      key.store(one);
      for (Mask16 rest = all & ~hits; rest != 0; rest &= rest - 1) one[first(rest)] = kNobody;
      key = Floats::load(one);
    }
    if (Alone && level == 0) {
      for (Mask16 rest = hits; rest != 0; rest &= rest - 1) fetch(mesh, first_node + first(rest));
    }
    return hits;
  }
  /// Where nodes are to wait: whether some are left is as hard to foresee as a coin.
  [[gnu::always_inline]] void put(const Floats& key, std::uint32_t first_node, Mask16 rest,
                                  float gone_to) {
    key.store(key_[size_]);
    gone_to_[size_] = gone_to;
    rest_[size_] = rest;
    first_node_[size_] = first_node;
  }
  /// Lets the nodes that the ray meets on a level of two blocks wait, of which the nearer one comes
  /// last, and turns to the nearest.
  RayStep start_between_two(const MeshView& mesh, std::uint32_t level) {
    Floats key[2];
    const Mask16 hits[2] = {find(mesh, level, 0, key[0]), find(mesh, level, kLanes, key[1])};
    const std::uint32_t nearest[2] = {reduce_min_positive(key[0]), reduce_min_positive(key[1])};
    const std::uint32_t nearer = nearest[0] < nearest[1] ? 0 : 1;
    const std::uint32_t least = nearest[0] < nearest[1] ? nearest[0] : nearest[1];
    for (std::uint32_t k = 0; k < 2; ++k) {
      size_ = k == nearer ? 1U : 0U;
      put(key[k], level << kLevelShift | k * kLanes, hits[k], 0.0F);
    }
    gone_to_[1] = __builtin_bit_cast(float, least);
    rest_[1] &= ~(1U << least % kLanes);
    size_ = rest_[1] != 0 ? 2 : 1;
    return aim(least, first_node_[1]) ? step_into(first_node_[1]) : kTakeNext;
  }
  /// Lets those of sixteen nodes wait that the ray meets, and aims at the nearest of them: false if
  /// there is none.
  [[gnu::always_inline]] bool meet(const MeshView& mesh, std::uint32_t level,
                                   std::uint32_t first_node) {
    Floats key;
    const Mask16 hits = find(mesh, level, first_node, key);
    if (hits == 0) return false;
    const std::uint32_t nearest = reduce_min_positive(key);
    const std::uint32_t named = level << kLevelShift | first_node;
    put(key, named, hits & ~(1U << nearest % kLanes), __builtin_bit_cast(float, nearest));
    size_ += (hits & (hits - 1)) != 0 ? 1U : 0U;
    return aim(nearest, named);
  }
  /// At the node with that key; false if it begins behind what was met.
  [[gnu::always_inline]] bool aim(std::uint32_t key, std::uint32_t first_node) {
    const std::uint32_t lane = key % kLanes;
    node_ = first_node + lane;
    entry_ = __builtin_bit_cast(float, key - lane);
    return entry_ <= last_;
  }
  /// Into nodes of the level of this one.
  [[nodiscard]] static RayStep step_into(std::uint32_t node) {
    return node >> kLevelShift != 0 ? kEnterInner : kEnterLeaf;
  }

  /// The least key of those that still wait: they are gone to by their order.
  [[nodiscard]] std::uint32_t nearest(std::uint32_t at) const {
    const Floats key = Floats::load(key_[at]);
    return reduce_min_positive(select(key > Floats(gone_to_[at]), key, Floats(kNobody)));
  }
  static void fetch_corners(const MeshView& mesh, std::uint32_t leaf) {
    if (mesh.corner[0] == nullptr) {
      __builtin_prefetch(mesh.leaf_vertex + std::size_t{leaf} * kMeshFanout);
      if (mesh.leaf_point != nullptr) {
        __builtin_prefetch(mesh.leaf_point + std::size_t{leaf} * kMeshFanout);
      }
      __builtin_prefetch(places_of(mesh, leaf, 0));
      __builtin_prefetch(places_of(mesh, leaf, 2));
      return;
    }
    for (const std::uint32_t* const corner : mesh.corner) {
      __builtin_prefetch(corner + std::size_t{leaf} * kMeshFanout);
    }
  }

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
    asked_.triangles &= bits(enter(mesh.box + std::size_t{6} * first_slot, in));
    if (!Alone && asked_.triangles != 0) fetch_corners(mesh, leaf);
  }

  /// Asks for vertices of a leaf that lists them, before it is known which of its triangles are to
  /// be looked at: they are neighbours.
  static void fetch_some_vertices(const MeshView& mesh, std::uint32_t leaf) {
    constexpr std::uint32_t kApart = 2;
    const std::uint32_t* const vertex = mesh.leaf_vertex + std::size_t{leaf} * kMeshFanout;
    for (std::uint32_t i = 0; i < kMeshFanout; i += kApart) {
      __builtin_prefetch(mesh.vertex + std::size_t{3} * vertex[i]);
    }
    __builtin_prefetch(mesh.triangle + std::size_t{leaf} * kMeshFanout);
  }

  /// Asks for their vertices, once their corners are there.
  [[gnu::always_inline]] void fetch_vertices(const MeshView& mesh, const Asked& asked) const {
    const std::uint32_t first_slot = asked.leaf * kMeshFanout;
    for (Mask16 rest = asked.triangles; rest != 0; rest &= rest - 1) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t corner = corner_of(mesh, k, first_slot + first(rest));
        __builtin_prefetch(mesh.vertex + std::size_t{3} * corner);
      }
    }
    __builtin_prefetch(mesh.triangle + first_slot);
  }

  bool cross_triangles(const MeshView& mesh, const Asked& asked, const RaySlotVisitor& visitor) {
    Mask16 triangles = asked.triangles;
    const std::uint32_t first_slot = asked.leaf * kMeshFanout;
    for (; triangles != 0; triangles &= triangles - 1) {
      const std::uint32_t slot = first_slot + first(triangles);
      SurfaceHit hit;
      const Crossing crossing = cross(crossing_ray(*own_, ray_), load_triangle(mesh, slot), hit);
      if (crossing == Crossing::none) continue;
      const double limit = crossing == Crossing::found
                               ? visitor.meet(visitor.context, ray_, slot, hit, limit_)
                               : visitor.look(visitor.context, ray_, slot, limit_);
      if (limit != limit_) set_limit(limit);
      if (limit < 0.0) return false;
    }
    return true;
  }

  const SurfaceRayColumns<kRoom>* own_;
  const ReadyRays<kRoom>* rays_;
  /// Not set where triangles have boxes.
  RayLine line_;
  std::uint32_t ray_;
  /// Where the bounds of sixteen nodes lie that it passes as it enters and leaves them.
  std::uint32_t near_bound_[3];
  std::uint32_t far_bound_[3];
  double limit_;
  float last_;
  /// What it goes to next, and when it enters that.
  std::uint32_t node_;
  float entry_;
  Asked asked_;
  /// Nodes that wait, in blocks of sixteen or fewer that follow each other: no more than one for
  /// each level but the top one, of which there may be two; and one more, of which none is left.
  static constexpr std::uint32_t kMostWaiting = kMaxMeshLevels + 2;
  std::uint32_t size_;
  Mask16 rest_[kMostWaiting];
  std::uint32_t first_node_[kMostWaiting];
  float gone_to_[kMostWaiting];
  /// When each is entered, as bits of a positive float that are ordered as it is, but for the last
  /// four, which tell which it is; kNobody where none ever waited.
  alignas(64) float key_[kMostWaiting][kLanes];
};

/// Rays that have not begun their way, in their order.
class WaitingRays {
 public:
  WaitingRays(const MeshView& mesh, const SurfaceRays& rays, const double* limits,
              std::uint32_t count)
      : mesh_(mesh), rays_(rays), limits_(limits) {
    for (std::uint32_t first = 0; first < count; first += kRayLanes) {
      const Mask16 come = make_ready<RaysInLanes>(mesh.span, rays, limits, first, ready_);
      come_ |= std::uint64_t{come} << first;
    }
    if (count < kRaysAtOnce) come_ &= (std::uint64_t{1} << count) - 1U;
  }

  /// Lets the next one start that does not pass the mesh by; false if there is none.
  [[gnu::always_inline]] bool start(RayWalk<false>& walk, RayStep& step) {
    if (come_ == 0) return false;
    const auto ray = static_cast<std::uint32_t>(__builtin_ctzll(come_));
    come_ &= come_ - 1;
    step = walk.start(mesh_, rays_, ready_, ray, limits_[ray]);
    return true;
  }

 private:
  const MeshView& mesh_;
  const SurfaceRays& rays_;
  const double* limits_;
  std::uint64_t come_ = 0;
  ReadyRays<kRaysAtOnce> ready_;
};

/// Rays that go through a mesh side by side, so that none waits for memory. In each round all take
/// the same kind of step one after the other, so that the processor foresees which.
class RaysSideBySide {
 public:
  RaysSideBySide(const MeshView& mesh, const RaySlotVisitor& visitor, WaitingRays& waiting)
      : mesh_(mesh), visitor_(visitor), waiting_(waiting) {}

  void run() {
    for (Walk& walk : walk_) begin(walk);
    const RayStep first_step = mesh_.box != nullptr ? kFetchVertices : kFindTriangles;
    while (going_ != 0) {
      // Asked for before other rays take their steps.
      for (Walk* const walk : steps_[kEnterLeaf]) walk->fetch_leaf(mesh_);
      each(kFindTriangles,
           [&](Walk& walk) { put(walk, walk.find_triangles(mesh_) ? kFetchVertices : kTakeNext); });
      each(kCrossTriangles, [&](Walk& walk) {
        put(walk, walk.cross_triangles(mesh_, visitor_) ? kTakeNext : kEnd);
      });
      each(kFetchVertices, [&](Walk& walk) {
        walk.fetch_vertices(mesh_);
        put(walk, kCrossTriangles);
      });
      each(kEnterLeaf,
           [&](Walk& walk) { put(walk, walk.enter_leaf(mesh_) ? first_step : kTakeNext); });
      each(kEnterInner, [&](Walk& walk) { put(walk, walk.enter_inner(mesh_)); });
      each(kTakeNext, [&](Walk& walk) { put(walk, walk.take_next()); });
      each(kEnd, [&](Walk& walk) {
        --going_;
        begin(walk);
      });
    }
  }

 private:
  static constexpr std::uint32_t kWalks = 32;
  using Walk = RayWalk<false>;
  /// Rays that wait for the same kind of step.
  struct Waiting {
    std::uint32_t count = 0;
    Walk* walk[kWalks] = {};

    [[nodiscard]] Walk* const* begin() const { return walk; }
    [[nodiscard]] Walk* const* end() const { return walk + count; }
  };

  /// Lets the next ray go whose turn it is, if there is one.
  void begin(Walk& walk) {
    RayStep step;
    if (!waiting_.start(walk, step)) return;
    ++going_;
    put(walk, step);
  }
  [[gnu::always_inline]] void put(Walk& walk, RayStep step) {
    Waiting& waiting = steps_[step];
    waiting.walk[waiting.count++] = &walk;
  }
  /// Takes all that wait for this kind of step now.
  template <typename Step>
  [[gnu::always_inline]] void each(RayStep kind, Step&& step) {
    const Waiting now = steps_[kind];
    steps_[kind].count = 0;
    for (Walk* const walk : now) step(*walk);
  }

  const MeshView& mesh_;
  const RaySlotVisitor& visitor_;
  WaitingRays& waiting_;
  std::uint32_t going_ = 0;
  Waiting steps_[kRaySteps];
  Walk walk_[kWalks];
};

/// Shows the triangles that each ray may meet, its nearest leaf first.
inline void show_on_rays(const MeshView& mesh, const SurfaceRays& rays, const double* limits,
                         std::uint32_t count, const RaySlotVisitor& visitor) {
  WaitingRays waiting(mesh, rays, limits, count);
  RaysSideBySide(mesh, visitor, waiting).run();
}
/// The same of one ray.
inline void show_on_ray(const MeshView& mesh, const LoneSurfaceRay& ray, double limit,
                        const RaySlotVisitor& visitor) {
  if (!(limit >= 0.0)) return;
  ReadyRays<1> ready;
  if (!make_near_ready(mesh.span, ray, ready) &&
      make_ready<RayInNumbers>(mesh.span, ray, &limit, 0, ready) == 0) {
    return;
  }
  RayWalk<true> walk;
  walk.go(mesh, walk.start(mesh, ray, ready, 0, limit), visitor);
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
