// Adapters of Bullet's two broad phases: dynamic trees (BulletTrees) and sweep and prune
// (BulletSweep). Bullet's allocator is global, so the bytes of an engine are counted while it
// works.

#include "bench/contenders/engines.h"
#include "bench/peers/adapter_tools.h"
#include "bench/peers/registry.h"

#include <malloc.h>

#include <BulletCollision/BroadphaseCollision/btAxisSweep3.h>
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <LinearMath/btAabbUtil2.h>
#include <LinearMath/btAlignedAllocator.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

using Bytes = std::atomic<std::size_t>;

Bytes nobodys_bytes{0};
/// Byte counter of the current engine: Bullet has one global allocator.
std::atomic<Bytes*> allocated_bytes{&nobodys_bytes};

void* counted_allocate(std::size_t size) {
  void* memory = std::malloc(size);
  *allocated_bytes.load() += malloc_usable_size(memory);
  return memory;
}

void counted_free(void* memory) {
  *allocated_bytes.load() -= malloc_usable_size(memory);
  std::free(memory);
}

/// Installs the counting allocator; must run before Bullet allocates anything.
void count_memory() {
  static const bool once = [] {
    btAlignedAllocSetCustom(counted_allocate, counted_free);
    return true;
  }();
  static_cast<void>(once);
}

btVector3 to_bullet(const Vec3f& v) {
  return {v.x(), v.y(), v.z()};
}

Pair rows_of(const btBroadphaseProxy& a, const btBroadphaseProxy& b) {
  return ordered(row_of(a.m_clientObject), row_of(b.m_clientObject));
}

/// Common parts of both broad phases: one thread, proxies by row, and bytes.
class BulletAdapter : public PairsAdapter {
 public:
  BulletAdapter() {
    count_memory();
    allocated_bytes = &bytes_;
  }
  ~BulletAdapter() override { allocated_bytes = &nobodys_bytes; }

  [[nodiscard]] bool is_serial() const final { return true; }
  /// Bytes of the broad phase, the proxies and the pair cache.
  [[nodiscard]] std::size_t bytes() const final {
    return bytes_ + proxies_.capacity() * sizeof(proxies_[0]);
  }

 protected:
  template <typename BroadPhase>
  void set_boxes(BroadPhase& broad_phase, std::span<const std::uint32_t> rows,
                 std::span<const Aabb> boxes) {
    for (const std::uint32_t row : rows) {
      broad_phase.setAabb(proxies_[row], to_bullet(boxes[row].min), to_bullet(boxes[row].max),
                          nullptr);
    }
  }
  /// Adds proxies for new rows.
  template <typename BroadPhase>
  void add_proxies(BroadPhase& broad_phase, std::span<const Aabb> boxes) {
    proxies_.reserve(boxes.size());
    for (std::size_t i = proxies_.size(); i < boxes.size(); ++i) {
      proxies_.push_back(broad_phase.createProxy(to_bullet(boxes[i].min), to_bullet(boxes[i].max),
                                                 0, pointer_of(i), 1, -1, nullptr));
    }
  }

  std::vector<btBroadphaseProxy*> proxies_;
  Bytes bytes_{0};
};

/// Bullet 3 in float: btDbvtBroadphase, two dynamic trees (moving and resting) with a hashed cache
/// of overlapping pairs. Only changed boxes are set. Bullet supports one thread only.
/// Settings, the best of those tried (measured by `winnow dev throughput --peers`): deferred
/// collision, except in a frame after one that changed the tree for at most 1/16 of the boxes; a
/// margin of a tenth of the mean edge, twice the usual step; otherwise defaults. A full clean-up of
/// the pair cache per frame and dynamic balancing were slower. Because of the margin and the
/// gradual clean-up, the pair cache is a superset and is filtered by the exact boxes in the
/// proxies.
class BulletTrees final : public BulletAdapter {
 public:
  // Frees the proxies directly: Bullet's own destruction of a proxy searches the whole pair cache,
  // and nothing uses the proxies any more.
  ~BulletTrees() override {
    allocated_bytes = &bytes_;
    for (btBroadphaseProxy* proxy : proxies_) btAlignedFree(proxy);
  }

  [[nodiscard]] std::string name() const override { return "Bullet dbvt"; }

 private:
  struct Trees : btDbvtBroadphase {
    Trees() { m_deferedcollide = true; }
  };

  void build(std::span<const Aabb> boxes) override {
    allocated_bytes = &bytes_;
    gDbvtMargin = static_cast<btScalar>(0.1 * mean_edge(boxes));
    margin_ = gDbvtMargin;
    add_proxies(trees_, boxes);
    trees_.optimize();
    defer_next_ = trees_.m_deferedcollide;
  }

  void update(std::span<const std::uint32_t> changed_rows,
              std::span<const Aabb> all_boxes) override {
    allocated_bytes = &bytes_;
    gDbvtMargin = margin_;  // a global of Bullet; another engine may have changed it
    const unsigned known = trees_.m_updates_done;
    set_boxes(trees_, changed_rows, all_boxes);
    add_proxies(trees_, all_boxes);
    defer_next_ = trees_.m_updates_done - known > proxies_.size() / 16;
  }

  void find_pairs(std::span<const Aabb>) override {
    trees_.calculateOverlappingPairs(nullptr);
    trees_.m_deferedcollide = defer_next_;
    pairs_.clear();
    const btOverlappingPairCache& cache = *trees_.getOverlappingPairCache();
    const btBroadphasePair* found = cache.getOverlappingPairArrayPtr();
    const int count = cache.getNumOverlappingPairs();
    for (int i = 0; i < count; ++i) {
      const btBroadphaseProxy& a = *found[i].m_pProxy0;
      const btBroadphaseProxy& b = *found[i].m_pProxy1;
      if (TestAabbAgainstAabb2(a.m_aabbMin, a.m_aabbMax, b.m_aabbMin, b.m_aabbMax))
        pairs_.push_back(rows_of(a, b));
    }
  }

  Trees trees_;
  btScalar margin_ = 0;
  bool defer_next_ = true;
};

/// A pair cache that also stores its pairs as rows, so that they need not be copied out.
class RowPairs final : public btHashedOverlappingPairCache {
 public:
  explicit RowPairs(std::vector<Pair>& rows) : rows_(rows) {}

  btBroadphasePair* addOverlappingPair(btBroadphaseProxy* a, btBroadphaseProxy* b) override {
    const int known = GetCount();
    btBroadphasePair* const pair = btHashedOverlappingPairCache::addOverlappingPair(a, b);
    if (GetCount() > known) rows_.push_back(rows_of(*a, *b));
    return pair;
  }

  void* removeOverlappingPair(btBroadphaseProxy* a, btBroadphaseProxy* b,
                              btDispatcher* dispatcher) override {
    const btBroadphasePair* const pair = findPair(a, b);
    if (pair == nullptr) return nullptr;
    rows_[static_cast<std::size_t>(pair - getOverlappingPairArrayPtr())] = rows_.back();
    rows_.pop_back();  // as the base class does in its own array
    return btHashedOverlappingPairCache::removeOverlappingPair(a, b, dispatcher);
  }

 private:
  std::vector<Pair>& rows_;
};

/// Bullet 3 in float: bt32BitAxisSweep3, which sorts moved boxes on three axes and adds and removes
/// only pairs that change. Bullet supports one thread only. Coordinates are quantised to 31 bits of
/// the world; boxes that are closer than a quantum are reported as well. Each object is inserted
/// singly and passes half of the others on each axis.
/// Settings, the best of those tried (measured by `winnow dev throughput --peers`): a world four
/// times as wide as the first boxes, and no tree for rays.
class BulletSweep final : public BulletAdapter {
 public:
  ~BulletSweep() override { allocated_bytes = &bytes_; }

  [[nodiscard]] std::string name() const override { return "Bullet sweep"; }
  /// The first frame takes seconds for more objects, and minutes for 100,000.
  [[nodiscard]] std::size_t largest() const override { return 5'000; }

 private:
  void build(std::span<const Aabb> boxes) override { build(boxes, boxes.size()); }

  void update(std::span<const std::uint32_t> changed_rows,
              std::span<const Aabb> all_boxes) override {
    allocated_bytes = &bytes_;
    if (!has_room_for(changed_rows, all_boxes)) {
      build(all_boxes, 2 * all_boxes.size());
    } else {
      set_boxes(*sweep_, changed_rows, all_boxes);
      add_proxies(*sweep_, all_boxes);
    }
  }

  void find_pairs(std::span<const Aabb>) override {}

  [[nodiscard]] bool is_inside(const Aabb& box) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (box.min[axis] <= world_.min[axis] || box.max[axis] >= world_.max[axis]) return false;
    }
    return true;
  }

  /// Returns false if a box leaves the world. Bullet would still find the pairs of such a box, but
  /// by testing it against all other boxes outside.
  [[nodiscard]] bool has_room_for(std::span<const std::uint32_t> changed_rows,
                                  std::span<const Aabb> all_boxes) const {
    if (all_boxes.size() > handles_) return false;
    const auto new_boxes = all_boxes.subspan(proxies_.size());
    return std::all_of(changed_rows.begin(), changed_rows.end(),
                       [&](std::uint32_t row) { return is_inside(all_boxes[row]); }) &&
           std::all_of(new_boxes.begin(), new_boxes.end(),
                       [&](const Aabb& box) { return is_inside(box); });
  }

  void build(std::span<const Aabb> boxes, std::size_t handles) {
    allocated_bytes = &bytes_;
    world_ = {};
    for (const Aabb& box : boxes) world_.merge(box);
    if (boxes.empty()) world_ = {{0, 0, 0}, {0, 0, 0}};
    const Vec3f edges = world_.max - world_.min;
    const Vec3f around = Vec3f::constant(1.5F * std::max({edges.x(), edges.y(), edges.z()}) + 1.0F);
    world_ = {world_.min - around, world_.max + around};
    handles_ = std::max<std::size_t>(handles, 1);
    proxies_.clear();
    sweep_.reset();
    pairs_.clear();
    cache_ = std::make_unique<RowPairs>(pairs_);
    sweep_ =
        std::make_unique<bt32BitAxisSweep3>(to_bullet(world_.min), to_bullet(world_.max),
                                            static_cast<unsigned>(handles_), cache_.get(), true);
    add_proxies(*sweep_, boxes);
  }

  std::unique_ptr<RowPairs> cache_;
  std::unique_ptr<bt32BitAxisSweep3> sweep_;
  Aabb world_;
  std::size_t handles_ = 0;
};

const RegisteredPeer<Engine, BulletTrees> kBulletTrees;
const RegisteredPeer<Engine, BulletSweep> kBulletSweep;

}  // namespace
}  // namespace winnow::bench
