// Ray traversal of a mesh: tests sixteen nodes at a time in their 16-bit units, nearest first, then
// the triangles of a leaf (mesh_ray_triangles.wide.h). All tests of nodes are in float and keep
// nodes for which rounding makes the result uncertain. One ray is traversed alone, several side by
// side.

#include "pipeline/mesh/mesh_rays.kernel.h"

#include "partitions/tree/traversal.wide.h"
#include "pipeline/mesh/mesh_ray_triangles.wide.h"
#include "simd/lanes/positive_min_max.h"

namespace winnow {
namespace WINNOW_ISA_NAME::mesh {
namespace {

/// Passes the triangles of a leaf to ClosestHits. Functions return the ray's new limit.
template <std::uint32_t Room>
struct ClosestReceiver {
  const MeshView& mesh;
  const SurfaceRayColumns<Room>& rays;
  ClosestHits<Room>& hits;

  [[gnu::always_inline]] double hit(std::uint32_t ray, std::uint32_t slot, const SurfaceHit& found,
                                    double limit) {
    return hits.take(rays, ray, mesh.triangle[slot] & kTriangleNumberMask, found, limit);
  }
  [[gnu::always_inline]] double candidate(std::uint32_t ray, std::uint32_t slot, double limit) {
    const double lowered = hits.test(hits.context, ray, slot, hits.limit[ray]);
    return hits.lower(rays, ray, lowered, limit);
  }
};

/// Passes them to a visitor of all triangles.
struct AllReceiver {
  const CrossingVisitor& visitor;

  [[gnu::always_inline]] double hit(std::uint32_t, std::uint32_t slot, const SurfaceHit& found,
                                    double limit) {
    return visitor.visit_hit(visitor.context, slot, found, limit);
  }
  [[gnu::always_inline]] double candidate(std::uint32_t, std::uint32_t slot, double limit) {
    return visitor.visit_candidate(visitor.context, slot, limit);
  }
};

/// The next step of a ray: enter an inner node; enter a leaf to find the triangles that it may
/// cross; prefetch their vertices; test them; take the next open node; or end.
enum RayStep : std::uint32_t {
  kEnterInner,
  kEnterLeaf,
  kFetchVertices,
  kCrossTriangles,
  kTakeNext,
  kEnd,
  kRaySteps
};

/// A node that a ray goes to, and the time at which it enters the node.
struct RayNode {
  std::uint32_t level;
  std::uint32_t number;
  float entry;

  [[gnu::always_inline]] static RayNode none() { return {0, ~0U, 0.0F}; }
  [[nodiscard, gnu::always_inline]] bool is_some() const { return number != ~0U; }
  [[nodiscard, gnu::always_inline]] bool is_inner() const { return is_some() && level != 0; }
};

/// The traversal state of one ray. The next node is the nearest open node of the last block. Data
/// of the next step are prefetched. A single ray prefetches all data of a leaf that it may need,
/// because it has no other work in the meantime. Control flow uses branches rather than select:
/// branch prediction lets the processor start the next step early.
template <bool Single>
class RayTraversal {
 public:
  static constexpr std::uint32_t kRoom = Single ? 1 : kRaysAtOnce;

  /// Begins the traversal; `ray` is the ray's index in the columns and for the receiver. Returns
  /// the first node.
  [[gnu::always_inline]] RayNode start(const MeshView& mesh, const SurfaceRayColumns<kRoom>& own,
                                       const ReadyRays<kRoom>& rays, std::uint32_t ray,
                                       double limit) {
    own_ = &own;
    rays_ = &rays;
    ray_ = ray;
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const auto direction_bits = __builtin_bit_cast(std::uint64_t, own.ray.direction[axis][ray]);
      const auto upper = static_cast<std::uint32_t>(direction_bits >> 63U);
      near_bound_[axis] = (axis + 3U * upper) * kMeshFanout;
      far_bound_[axis] = (axis + 3U - 3U * upper) * kMeshFanout;
    }
    if (mesh.box == nullptr) line_.set(rays, ray);
    store_limit(limit);
    open_ = 0;
    // A top level with one or two nodes is skipped: its children are tested at once.
    const std::uint32_t top = mesh.levels - 1;
    if (top != 0 && mesh.count[top] == 2) return start_between_two(mesh, top - 1);
    if (top == 0 || mesh.count[top] != 1) return open_block(mesh, top, 0);
    return open_block(mesh, top - 1, 0);
  }

  /// Takes the nearest node of the last open block; requires an open block.
  [[gnu::always_inline]] RayNode take_next() {
    const auto at = 31U - static_cast<std::uint32_t>(__builtin_clz(open_));
    const Floats key = Floats::load(key_[at]);
    const std::uint32_t nearest =
        reduce_min_positive(select(key > Floats(gone_to_[at]), key, Floats(kClosedKey)));
    gone_to_[at] = __builtin_bit_cast(float, nearest);
    open_ ^= (is_open(key, gone_to_[at]) ^ 1U) << at;
    return node_of(nearest, level_[at], first_node_[at]);
  }
  /// Enters an inner node; returns the nearest of its children that the ray intersects.
  [[gnu::always_inline]] RayNode enter_inner(const MeshView& mesh, const RayNode& node) {
    return open_block(mesh, node.level - 1, node.number * kLanes);
  }
  [[nodiscard, gnu::always_inline]] bool has_open_nodes() const { return open_ != 0; }
  /// Runs the whole traversal of one ray. If triangles have boxes, a leaf's triangles are tested
  /// after the next nodes, so that their vertices are fetched in the meantime. Else nearly all data
  /// of a leaf are already in cache, and its triangles are tested at once.
  template <typename Receiver>
  [[gnu::always_inline]] void go(const MeshView& mesh, RayNode node, Receiver& receiver) {
    if (mesh.box != nullptr) return go_through_boxes(mesh, node, receiver);
    for (;;) {
      while (node.is_inner()) node = enter_inner(mesh, node);
      if (node.is_some()) {
        const std::uint32_t leaf = node.number;
        if (mesh.leaf_vertex != nullptr) fetch_some_vertices(mesh, leaf);
        const LineTriangles line = line_.near(mesh, leaf);
        const Mask16 triangles = triangles_of(mesh, leaf) & line.may;
        if (triangles != 0 &&
            !cross_triangles(mesh, {leaf, 0.0F, triangles, line.sure}, receiver)) {
          return;
        }
      }
      if (!has_open_nodes()) return;
      node = take_next();
    }
  }

  // The functions below are for rays that are traversed side by side; their state is kept between
  // steps.

  /// Sets the next node; returns the step that processes it.
  [[gnu::always_inline]] RayStep step_to(const RayNode& node) {
    node_ = node;
    if (!node.is_some()) return next_step();
    return node.level != 0 ? kEnterInner : kEnterLeaf;
  }
  /// The step to take if there is no next node.
  [[nodiscard, gnu::always_inline]] RayStep next_step() const {
    return has_open_nodes() ? kTakeNext : kEnd;
  }
  [[gnu::always_inline]] RayStep enter_inner(const MeshView& mesh) {
    return step_to(enter_inner(mesh, node_));
  }
  /// Finds the triangles of the current leaf to test; returns false if there are none. Their
  /// vertices must be fetched next.
  [[gnu::always_inline]] bool enter_leaf(const MeshView& mesh) {
    candidates_ = select_triangles(mesh, node_);
    return candidates_.triangles != 0;
  }
  /// Prefetches the data of the current leaf that are read first. Nodes are few enough to be in
  /// cache.
  [[gnu::always_inline]] void fetch_leaf(const MeshView& mesh) const { fetch(mesh, node_.number); }
  [[gnu::always_inline]] void fetch_vertices(const MeshView& mesh) const {
    fetch_vertices(mesh, candidates_);
  }
  /// As enter_leaf, for triangles without boxes: returns false if the line crosses none. Prefetches
  /// the vertices of the first triangle only, since there are hardly ever more.
  [[gnu::always_inline]] bool find_triangles(const MeshView& mesh) {
    const LineTriangles line = line_.near(mesh, node_.number);
    candidates_ = {node_.number, 0.0F, triangles_of(mesh, node_.number) & line.may, line.sure};
    fetch_vertices(mesh,
                   node_.number * kMeshFanout + first(candidates_.triangles | 1U << (kLanes - 1)));
    __builtin_prefetch(mesh.triangle + node_.number * kMeshFanout);
    return candidates_.triangles != 0;
  }
  /// Returns false if the receiver ends the ray.
  template <typename Receiver>
  [[gnu::always_inline]] bool cross_triangles(const MeshView& mesh, Receiver& receiver) {
    return cross_triangles(mesh, candidates_, receiver);
  }

 private:
  static constexpr float kMinTau = 0x1p-100F;
  static constexpr float kMaxTau = 1e38F;
  /// The key of a node that is not open; more than kMaxTau.
  static constexpr float kClosedKey = __FLT_MAX__;
  /// Keys distinguish this many nodes.
  static constexpr std::uint32_t kNumbers = 2 * kLanes;

  /// A leaf to be tested: the time at which the ray enters it (only for go_through_boxes), the
  /// triangles that it may cross, and a subset that it certainly crosses.
  struct LeafCandidates {
    std::uint32_t leaf = 0;
    float entry = 0.0F;
    Mask16 triangles = 0;
    Mask16 sure = 0;
  };

  template <typename Receiver>
  [[gnu::noinline]] void go_through_boxes(const MeshView& mesh, RayNode node, Receiver& receiver) {
    LeafCandidates before;
    for (;;) {
      while (node.is_inner()) node = enter_inner(mesh, node);
      LeafCandidates now;
      if (node.is_some()) {
        now = select_triangles(mesh, node);
        if (now.triangles != 0) fetch_vertices(mesh, now);
      }
      if (before.triangles != 0 && before.entry <= limit_tau_ &&
          !cross_triangles(mesh, before, receiver)) {
        return;
      }
      before = now;
      if (has_open_nodes()) {
        node = take_next();
      } else {
        if (now.triangles == 0) return;
        node = RayNode::none();
      }
    }
  }

  void store_limit(double limit) {
    limit_ = limit;
    const double rest = (limit - rays_->entry[place()]) * rays_->pace[place()] * (1.0 + 0x1p-20);
    const float most = rest < 1e38 ? static_cast<float>(rest) : kMaxTau;
    limit_tau_ = most > kMinTau ? most : kMinTau;
    limit_key_ =
        __builtin_bit_cast(float, __builtin_bit_cast(std::uint32_t, limit_tau_) | (kNumbers - 1U));
  }
  /// Lowers the limit; closes open nodes beyond it.
  void set_limit(double limit) {
    store_limit(limit);
    for (std::uint32_t rest = open_; rest != 0; rest &= rest - 1) {
      const std::uint32_t at = first(rest);
      open_ ^= (is_open(Floats::load(key_[at]), gone_to_[at]) ^ 1U) << at;
    }
  }
  /// Returns 1 if nodes with these keys come after `gone_to` and before the limit, else 0.
  [[nodiscard, gnu::always_inline]] std::uint32_t is_open(const Floats& key, float gone_to) const {
    return bits((key > Floats(gone_to)) & (key <= Floats(limit_key_))) != 0 ? 1U : 0U;
  }

  /// Returns which of the sixteen boxes in columns at `bounds` the ray intersects, and writes the
  /// times at which it enters them to `in`.
  [[gnu::always_inline]] LaneMask<float> enter(const std::uint16_t* bounds, Floats& in) const {
    in = Floats(kMinTau);
    Floats out(limit_tau_);
    for (int axis = 0; axis < 3; ++axis) {
      const Floats inverse(rays_->inverse[axis][place()]);
      const Floats near = load_short(bounds + near_bound_[axis]);
      const Floats far = load_short(bounds + far_bound_[axis]);
      in = larger_positive(in, multiply_add(near, inverse, Floats(rays_->near[axis][place()])));
      out = smaller_positive(out, multiply_add(far, inverse, Floats(rays_->far[axis][place()])));
    }
    return in <= out;
  }

  /// Finds which of sixteen nodes the ray intersects, and their keys, whose low bits number the
  /// nodes from `number` on.
  [[gnu::always_inline]] Mask16 find(const MeshView& mesh, std::uint32_t level,
                                     std::uint32_t first_node, std::uint32_t number, Floats& key) {
    alignas(64) static constexpr std::uint32_t kEach[kNumbers] = {
        0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15,
        16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31};
    Floats in;
    const LaneMask<float> entered = enter(mesh.node[level] + std::size_t{6} * first_node, in);
    const Floats each = Floats::load(reinterpret_cast<const float*>(kEach + number));
    const Floats without_number(__builtin_bit_cast(float, ~(kNumbers - 1U)));
    key = select(entered, (in & without_number) | each, Floats(kClosedKey));
    Mask16 hits = bits(entered);
    if (first_node + kLanes > mesh.count[level]) [[unlikely]] {
      hits &= leave_out(present(mesh.count[level], first_node), hits, key);
    }
    if (Single && level == 0) {
      for (Mask16 rest = hits; rest != 0; rest &= rest - 1) fetch(mesh, first_node + first(rest));
    }
    return hits;
  }
  /// Sets the keys of lanes beyond the level's count to kClosedKey. These lanes have empty boxes,
  /// but if boxes are grown by a large amount, the ray can intersect them.
  [[gnu::always_inline]] static Mask16 leave_out(Mask16 there, Mask16 hits, Floats& key) {
    if ((hits & ~there) == 0) [[likely]]
      return there;
    alignas(64) float one[kLanes];
    key.store(one);
    for (Mask16 rest = hits & ~there; rest != 0; rest &= rest - 1) one[first(rest)] = kClosedKey;
    key = Floats::load(one);
    return there;
  }
  /// Stores a block of open nodes at `at`. Nodes with keys up to `gone_to` have been visited;
  /// `rest` is the mask of the nodes that have not. Node numbers in keys count from `first_node`.
  [[gnu::always_inline]] void put(std::uint32_t at, std::uint32_t level, std::uint32_t first_node,
                                  const Floats& key, Mask16 rest, float gone_to) {
    key.store(key_[at]);
    gone_to_[at] = gone_to;
    level_[at] = level;
    first_node_[at] = first_node;
    open_ |= (rest != 0 ? 1U : 0U) << at;
  }
  /// Opens a level of two blocks: stores the nodes that the ray intersects, the nearer block last,
  /// and returns the nearest node.
  [[gnu::always_inline]] RayNode start_between_two(const MeshView& mesh, std::uint32_t level) {
    Floats key[2];
    const Mask16 hits[2] = {find(mesh, level, 0, 0, key[0]),
                            find(mesh, level, kLanes, kLanes, key[1])};
    if ((hits[0] | hits[1]) == 0) return RayNode::none();
    const std::uint32_t nearest = reduce_min_positive(smaller_positive(key[0], key[1]));
    const std::uint32_t nearer = nearest / kLanes % 2;
    const Mask16 both = hits[1] << kLanes | hits[0];
    const Mask16 rest = both & ~(1U << nearest % kNumbers);
    for (std::uint32_t k = 0; k < 2; ++k) {
      put(1 - (k ^ nearer), level, 0, key[k], rest >> k * kLanes & 0xFFFFU,
          __builtin_bit_cast(float, nearest));
    }
    return node_of(nearest, level, 0);
  }
  /// Opens sixteen nodes: returns the nearest one that the ray intersects and stores the others
  /// that it intersects.
  [[gnu::always_inline]] RayNode open_block(const MeshView& mesh, std::uint32_t level,
                                            std::uint32_t first_node) {
    Floats key;
    const Mask16 hits = find(mesh, level, first_node, 0, key);
    if (hits == 0) return RayNode::none();
    // The time of entry is used only if triangles have boxes.
    if (mesh.box == nullptr && (hits & (hits - 1)) == 0) {
      return {level, first_node + first(hits), 0.0F};
    }
    const std::uint32_t nearest = reduce_min_positive(key);
    put(mesh.levels - 1 - level, level, first_node, key, hits & ~(1U << nearest % kLanes),
        __builtin_bit_cast(float, nearest));
    return node_of(nearest, level, first_node);
  }
  /// The node with this key.
  [[gnu::always_inline]] static RayNode node_of(std::uint32_t key, std::uint32_t level,
                                                std::uint32_t first_node) {
    const std::uint32_t number = key % kNumbers;
    return {level, first_node + number, __builtin_bit_cast(float, key - number)};
  }

  // Compilers delete calls of functions that only prefetch; always_inline prevents this.
  [[gnu::always_inline]] static void fetch_corners(const MeshView& mesh, std::uint32_t leaf) {
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

  [[gnu::always_inline]] static void fetch(const MeshView& mesh, std::uint32_t leaf) {
    if (Single || mesh.box == nullptr) fetch_corners(mesh, leaf);
    if (mesh.box == nullptr) return;
    const std::uint16_t* const box = mesh.box + std::size_t{6} * kMeshFanout * leaf;
    for (std::size_t k = 0; k < 3; ++k) __builtin_prefetch(box + 32 * k);
  }

  /// The lanes of the triangles that a leaf has.
  [[nodiscard, gnu::always_inline]] static Mask16 triangles_of(const MeshView& mesh,
                                                               std::uint32_t leaf) {
    const std::uint32_t first_slot = leaf * kMeshFanout;
    if (first_slot + kLanes <= mesh.triangle_count) [[likely]]
      return lanes_below(kLanes);
    return present(mesh.triangle_count, first_slot);
  }
  /// Finds the triangles of a leaf to test; if triangles have boxes, tests the boxes.
  [[gnu::always_inline]] LeafCandidates select_triangles(const MeshView& mesh,
                                                         const RayNode& leaf) const {
    LeafCandidates candidates{leaf.number, leaf.entry, triangles_of(mesh, leaf.number), 0};
    if (mesh.box == nullptr) return candidates;
    Floats in;
    const std::uint32_t first_slot = leaf.number * kMeshFanout;
    candidates.triangles &= bits(enter(mesh.box + std::size_t{6} * first_slot, in));
    if (!Single && candidates.triangles != 0) fetch_corners(mesh, leaf.number);
    return candidates;
  }

  /// Prefetches every second vertex of a leaf that lists its vertices, before it is determined
  /// which triangles are tested. The vertices are usually close together in memory.
  [[gnu::always_inline]] static void fetch_some_vertices(const MeshView& mesh, std::uint32_t leaf) {
    constexpr std::uint32_t kApart = 2;
    const std::uint32_t* const vertex = mesh.leaf_vertex + std::size_t{leaf} * kMeshFanout;
    for (std::uint32_t i = 0; i < kMeshFanout; i += kApart) {
      __builtin_prefetch(mesh.vertex + std::size_t{3} * vertex[i]);
    }
    __builtin_prefetch(mesh.triangle + std::size_t{leaf} * kMeshFanout);
  }

  /// Prefetches the vertices of a triangle whose corner indices are in cache.
  [[gnu::always_inline]] static void fetch_vertices(const MeshView& mesh, std::uint32_t slot) {
    for (std::size_t k = 0; k < 3; ++k) {
      __builtin_prefetch(mesh.vertex + std::size_t{3} * corner_of(mesh, k, slot));
    }
  }
  [[gnu::always_inline]] static void fetch_vertices(const MeshView& mesh,
                                                    const LeafCandidates& candidates) {
    const std::uint32_t first_slot = candidates.leaf * kMeshFanout;
    for (Mask16 rest = candidates.triangles; rest != 0; rest &= rest - 1) {
      fetch_vertices(mesh, first_slot + first(rest));
    }
    __builtin_prefetch(mesh.triangle + first_slot);
  }

  template <typename Receiver>
  bool cross_triangles(const MeshView& mesh, const LeafCandidates& candidates, Receiver& receiver) {
    const std::uint32_t first_slot = candidates.leaf * kMeshFanout;
    for (Mask16 rest = candidates.triangles; rest != 0; rest &= rest - 1) {
      const std::uint32_t lane = first(rest);
      const std::uint32_t slot = first_slot + lane;
      SurfaceHit hit;
      const Crossing crossing =
          cross_slot((*own_)[place()], mesh, slot, (candidates.sure >> lane & 1U) != 0, hit);
      if (crossing == Crossing::none) continue;
      const double limit = crossing == Crossing::found ? receiver.hit(ray_, slot, hit, limit_)
                                                       : receiver.candidate(ray_, slot, limit_);
      if (limit < 0.0) return false;
      if (limit != limit_) set_limit(limit);
    }
    return true;
  }
  /// The ray's index in the columns.
  [[nodiscard, gnu::always_inline]] std::uint32_t place() const { return Single ? 0 : ray_; }

  const SurfaceRayColumns<kRoom>* own_;
  const ReadyRays<kRoom>* rays_;
  /// Not set if triangles have boxes.
  RayLine line_;
  std::uint32_t ray_;
  /// Offsets of the bounds of sixteen nodes that the ray passes as it enters and as it leaves.
  std::uint32_t near_bound_[3];
  std::uint32_t far_bound_[3];
  /// The limit in own t, as tau (see ReadyRays), and as an upper bound on the keys of nodes that
  /// the ray enters by then.
  double limit_;
  float limit_tau_;
  float limit_key_;
  /// For rays side by side: the next node, and the last leaf to be tested.
  RayNode node_;
  LeafCandidates candidates_;
  /// Open nodes, in blocks of up to sixteen: one block per level except the top one, which may have
  /// two; the lowest level last. Bit i of `open_` is set if block i has open nodes.
  std::uint32_t open_;
  std::uint32_t level_[kMaxMeshLevels];
  std::uint32_t first_node_[kMaxMeshLevels];
  float gone_to_[kMaxMeshLevels];
  /// Keys: the bits of the positive float at which a node is entered, which sort like the float,
  /// with the last five bits replaced by the node's number; kClosedKey for nodes that the ray
  /// misses.
  alignas(64) float key_[kMaxMeshLevels][kLanes];
};

/// Rays that have not started, in order.
class WaitingRays {
 public:
  WaitingRays(const MeshView& mesh, const SurfaceRays& rays, const double* limits,
              std::uint32_t count)
      : mesh_(mesh), rays_(rays), limits_(limits) {
    for (std::uint32_t first = 0; first < count; first += kRayLanes) {
      const Mask16 hits_box = make_ready<LaneRays>(mesh.span, rays, limits, first, ready_);
      waiting_ |= std::uint64_t{hits_box} << first;
    }
    if (count < kRaysAtOnce) waiting_ &= (std::uint64_t{1} << count) - 1U;
  }

  /// Starts the next ray that does not miss the mesh; returns false if there is none.
  [[gnu::always_inline]] bool start(RayTraversal<false>& walk, RayStep& step) {
    if (waiting_ == 0) return false;
    const auto ray = static_cast<std::uint32_t>(__builtin_ctzll(waiting_));
    waiting_ &= waiting_ - 1;
    step = walk.step_to(walk.start(mesh_, rays_, ready_, ray, limits_[ray]));
    return true;
  }

 private:
  const MeshView& mesh_;
  const SurfaceRays& rays_;
  const double* limits_;
  std::uint64_t waiting_ = 0;
  ReadyRays<kRaysAtOnce> ready_;
};

/// Traverses rays side by side, so that prefetches have time to complete. In each round, all rays
/// that need the same kind of step take it one after another, which makes branches predictable.
/// Triangles are tested first in a round, because a hit lowers the limit and closes nodes; new rays
/// begin last.
class RaysSideBySide {
 public:
  RaysSideBySide(const MeshView& mesh, ClosestReceiver<kRaysAtOnce>& receiver, WaitingRays& waiting)
      : mesh_(mesh), receiver_(receiver), waiting_(waiting) {}

  [[gnu::noinline]] void run() {
    for (Walk& walk : walk_) begin(walk);
    while (going_ != 0) {
      // Prefetch before other rays take their steps.
      for (Walk* const walk : steps_[kEnterLeaf]) walk->fetch_leaf(mesh_);
      each(kCrossTriangles, [&](Walk& walk) {
        put(walk, walk.cross_triangles(mesh_, receiver_) ? walk.next_step() : kEnd);
      });
      each(kFetchVertices, [&](Walk& walk) {
        walk.fetch_vertices(mesh_);
        put(walk, kCrossTriangles);
      });
      enter_leaves();
      each(kEnterInner, [&](Walk& walk) { put(walk, walk.enter_inner(mesh_)); });
      each(kTakeNext, [&](Walk& walk) { put(walk, walk.step_to(walk.take_next())); });
      each(kEnd, [&](Walk& walk) {
        --going_;
        begin(walk);
      });
    }
  }

 private:
  static constexpr std::uint32_t kWalks = 32;
  using Walk = RayTraversal<false>;
  /// Rays whose next step is of one kind.
  struct StepQueue {
    std::uint32_t count = 0;
    Walk* walk[kWalks] = {};

    [[nodiscard]] Walk* const* begin() const { return walk; }
    [[nodiscard]] Walk* const* end() const { return walk + count; }
  };

  /// If triangles have boxes, their corner indices are not in cache yet, so the vertices are
  /// prefetched in a separate step.
  [[gnu::always_inline]] void enter_leaves() {
    if (mesh_.box != nullptr) {
      return each(kEnterLeaf, [&](Walk& walk) {
        put(walk, walk.enter_leaf(mesh_) ? kFetchVertices : walk.next_step());
      });
    }
    each(kEnterLeaf, [&](Walk& walk) {
      put(walk, walk.find_triangles(mesh_) ? kCrossTriangles : walk.next_step());
    });
  }
  /// Starts the next ray, if there is one.
  void begin(Walk& walk) {
    RayStep step;
    if (!waiting_.start(walk, step)) return;
    ++going_;
    put(walk, step);
  }
  [[gnu::always_inline]] void put(Walk& walk, RayStep step) {
    StepQueue& waiting = steps_[step];
    waiting.walk[waiting.count++] = &walk;
  }
  /// Processes all rays whose next step is of this kind.
  template <typename Step>
  [[gnu::always_inline]] void each(RayStep kind, Step&& step) {
    const StepQueue now = steps_[kind];
    steps_[kind].count = 0;
    for (Walk* const walk : now) step(*walk);
  }

  const MeshView& mesh_;
  ClosestReceiver<kRaysAtOnce>& receiver_;
  WaitingRays& waiting_;
  std::uint32_t going_ = 0;
  StepQueue steps_[kRaySteps];
  Walk walk_[kWalks];
};

void find_closest(const MeshView& mesh, const SurfaceRays& rays, std::uint32_t count,
                  ClosestHits<kRaysAtOnce>& hits) {
  if (mesh.triangle_count == 0 || count == 0) return;
  ClosestReceiver<kRaysAtOnce> receiver{mesh, rays, hits};
  WaitingRays waiting(mesh, rays, hits.own_limit, count);
  RaysSideBySide(mesh, receiver, waiting).run();
}

template <typename Receiver>
void trace_ray(const MeshView& mesh, const SingleSurfaceRay& ray, double limit,
               Receiver& receiver) {
  if (mesh.triangle_count == 0 || !(limit >= 0.0)) return;
  ReadyRays<1> ready;
  if (!make_near_ready(mesh.span, ray, ready) &&
      make_ready<ScalarRay>(mesh.span, ray, &limit, 0, ready) == 0) {
    return;
  }
  RayTraversal<true> walk;
  walk.go(mesh, walk.start(mesh, ray, ready, 0, limit), receiver);
}

void find_closest_of_one(const MeshView& mesh, const SingleSurfaceRay& ray, ClosestHits<1>& hits) {
  ClosestReceiver<1> receiver{mesh, ray, hits};
  trace_ray(mesh, ray, hits.own_limit[0], receiver);
}

void visit_all(const MeshView& mesh, const SingleSurfaceRay& ray, double limit,
               const CrossingVisitor& visitor) {
  AllReceiver receiver{visitor};
  trace_ray(mesh, ray, limit, receiver);
}

}  // namespace
}  // namespace WINNOW_ISA_NAME::mesh

extern const MeshRayKernels WINNOW_KERNEL_TABLE(mesh_ray_kernels) = {
    WINNOW_ISA_NAME::mesh::place_rays,          WINNOW_ISA_NAME::mesh::find_closest,
    WINNOW_ISA_NAME::mesh::find_closest_of_one, WINNOW_ISA_NAME::mesh::visit_all,
    WINNOW_ISA_NAME::mesh::cross_triangle,
};

}  // namespace winnow
