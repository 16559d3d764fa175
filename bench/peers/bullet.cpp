#include "bench/common/sample.h"
#include "bench/peers/adapter_tools.h"
#include "bench/peers/adapters.h"

#include <malloc.h>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <LinearMath/btAlignedAllocator.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

std::atomic<std::size_t> allocated_bytes{0};

void* counted_allocate(std::size_t size) {
  void* memory = std::malloc(size);
  allocated_bytes += malloc_usable_size(memory);
  return memory;
}

void counted_free(void* memory) {
  allocated_bytes -= malloc_usable_size(memory);
  std::free(memory);
}

/// Before Bullet allocates anything: its allocator, counted.
void count_memory() {
  static const bool once = [] {
    btAlignedAllocSetCustom(counted_allocate, counted_free);
    return true;
  }();
  static_cast<void>(once);
}

btVector3 to_bullet(const Eigen::Vector3f& v) {
  return {v.x(), v.y(), v.z()};
}

bool overlap(const btBroadphaseProxy& a, const btBroadphaseProxy& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (a.m_aabbMin[axis] > b.m_aabbMax[axis] || b.m_aabbMin[axis] > a.m_aabbMax[axis]) {
      return false;
    }
  }
  return true;
}

std::uint32_t row_of(const btBroadphaseProxy& proxy) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(proxy.m_clientObject));
}

/// Bullet 3 in float: btDbvtBroadphase, two dynamic trees (moving and resting) with a hashed cache
/// of overlapping pairs; only changed boxes are set. One thread: it has no more.
/// Best of what was tried: deferred collision (1.3 to 2.5 times faster than one tree query per
/// moved box), a margin of 10 % of the mean edge (twice the usual step), otherwise its defaults; a
/// full clean-up of the pair cache each frame, or dynamic balancing, cost more than they save. The
/// pair cache is a superset because of the margin and the gradual clean-up: filtered by the exact
/// boxes that the proxies keep.
class BulletEngine final : public PairsAdapter {
 public:
  // Bullet wants each proxy destroyed one by one, which searches the whole pair cache every time;
  // nothing looks at them any more, so giving back their memory does.
  ~BulletEngine() override {
    for (btBroadphaseProxy* proxy : proxies_) btAlignedFree(proxy);
  }

  [[nodiscard]] std::string name() const override { return "Bullet dbvt"; }

  void start(std::span<const Aabb> boxes) override {
    const Stopwatch watch;
    gDbvtMargin = static_cast<btScalar>(0.1 * mean_edge(boxes));
    proxies_.reserve(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      void* row = reinterpret_cast<void*>(static_cast<std::uintptr_t>(i));
      proxies_.push_back(trees_.createProxy(to_bullet(boxes[i].min), to_bullet(boxes[i].max), 0,
                                            row, 1, -1, nullptr));
    }
    margin_ = gDbvtMargin;
    trees_.optimize();
    update_ms_ = watch.ms();
    find_pairs();
  }

  void frame(std::span<const std::uint32_t> changed_rows,
             std::span<const Aabb> all_boxes) override {
    const Stopwatch watch;
    gDbvtMargin = margin_;  // a global of Bullet; another engine may have changed it
    for (const std::uint32_t row : changed_rows) {
      trees_.setAabb(proxies_[row], to_bullet(all_boxes[row].min), to_bullet(all_boxes[row].max),
                     nullptr);
    }
    update_ms_ = watch.ms();
    find_pairs();
  }

  /// Trees, proxies and the pair cache, of all Bullet engines alive.
  [[nodiscard]] std::size_t bytes() const override {
    return allocated_bytes + proxies_.capacity() * sizeof(proxies_[0]);
  }

 private:
  struct Trees : btDbvtBroadphase {
    Trees() { m_deferedcollide = true; }
  };

  void find_pairs() {
    trees_.calculateOverlappingPairs(nullptr);
    pairs_.clear();
    const btOverlappingPairCache& cache = *trees_.getOverlappingPairCache();
    const btBroadphasePair* found = cache.getOverlappingPairArrayPtr();
    const int count = cache.getNumOverlappingPairs();
    for (int i = 0; i < count; ++i) {
      const btBroadphaseProxy& a = *found[i].m_pProxy0;
      const btBroadphaseProxy& b = *found[i].m_pProxy1;
      if (overlap(a, b)) pairs_.push_back(ordered(row_of(a), row_of(b)));
    }
  }

  Trees trees_;
  std::vector<btBroadphaseProxy*> proxies_;
  btScalar margin_ = 0;
};

}  // namespace

std::unique_ptr<Engine> make_bullet() {
  count_memory();
  return std::make_unique<BulletEngine>();
}

}  // namespace winnow::bench
