// winnow as the broad phase of Bullet: a btBroadphaseInterface for any btCollisionWorld or
// btDynamicsWorld, compared with Bullet's own btDbvtBroadphase in the same world.

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <btBulletCollisionCommon.h>
#include <winnow/partitions/partition.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/examples/check.h"
#include "tests/examples/programs/race.h"

namespace {

winnow::Aabb box_of(const btVector3& low, const btVector3& high) {
  return {{low.x(), low.y(), low.z()}, {high.x(), high.y(), high.z()}};
}

/// Bullet stores its objects in proxies, and pairs in a cache that its dispatcher reads. The
/// partition reports the pairs that begin and end; this class adds and removes only those pairs.
class WinnowBroadPhase final : public btBroadphaseInterface {
 public:
  btBroadphaseProxy* createProxy(const btVector3& low, const btVector3& high, int /*shape_type*/,
                                 void* user, int group, int mask,
                                 btDispatcher* /*dispatcher*/) override {
    auto proxy = std::make_unique<Proxy>(low, high, user, group, mask);
    proxy->m_uniqueId = ++last_id_;
    proxy->place = proxies_.size();
    const winnow::Key key =
        partition_.insert(box_of(low, high), reinterpret_cast<std::uintptr_t>(proxy.get()));
    check(bool{key}, "a proxy is inserted");
    // Bullet's rule: the mask of each object has a bit of the other object's group.
    check(partition_.set_filter(key, {.layers = static_cast<std::uint32_t>(group),
                                      .mask = static_cast<std::uint32_t>(mask)}) ==
              winnow::Status::ok,
          "it gets its filter");
    keys_.push_back(key);
    boxes_.push_back(box_of(low, high));
    proxies_.push_back(std::move(proxy));
    return proxies_.back().get();
  }

  void destroyProxy(btBroadphaseProxy* proxy, btDispatcher* dispatcher) override {
    send_moves();
    pairs_.removeOverlappingPairsContainingProxy(proxy, dispatcher);
    const std::size_t place = static_cast<Proxy*>(proxy)->place;
    check(partition_.remove(keys_[place]) == winnow::Status::ok, "a proxy is removed");
    proxies_.back()->place = place;
    std::swap(proxies_[place], proxies_.back());
    keys_[place] = keys_.back();
    boxes_[place] = boxes_.back();
    proxies_.pop_back();
    keys_.pop_back();
    boxes_.pop_back();
  }

  void setAabb(btBroadphaseProxy* proxy, const btVector3& low, const btVector3& high,
               btDispatcher* /*dispatcher*/) override {
    auto& mine = *static_cast<Proxy*>(proxy);
    if (low == mine.m_aabbMin && high == mine.m_aabbMax) return;
    mine.m_aabbMin = low;
    mine.m_aabbMax = high;
    boxes_[mine.place] = box_of(low, high);
    moved_.push_back(static_cast<std::uint32_t>(mine.place));
  }

  void getAabb(btBroadphaseProxy* proxy, btVector3& low, btVector3& high) const override {
    low = proxy->m_aabbMin;
    high = proxy->m_aabbMax;
  }

  void calculateOverlappingPairs(btDispatcher* dispatcher) override {
    send_moves();
    check(partition_.self_pairs(events_) == winnow::Status::ok, "pairs are found");
    for (const winnow::KeyPair& pair : events_.ended()) {
      // destroyProxy() has already removed the pairs of destroyed proxies from the cache.
      if (!partition_.contains(pair.first) || !partition_.contains(pair.second)) continue;
      pairs_.removeOverlappingPair(proxy_of(pair.first.id), proxy_of(pair.second.id), dispatcher);
    }
    for (const winnow::KeyPair& pair : events_.begun()) {
      pairs_.addOverlappingPair(proxy_of(pair.first.id), proxy_of(pair.second.id));
    }
  }

  btOverlappingPairCache* getOverlappingPairCache() override { return &pairs_; }
  const btOverlappingPairCache* getOverlappingPairCache() const override { return &pairs_; }

  /// Casts a ray or, if `low` and `high` are not zero, a box. Visits objects in the order of
  /// distance, so that a callback that has found a hit stops at boxes that begin behind it.
  void rayTest(const btVector3& from, const btVector3& to, btBroadphaseRayCallback& callback,
               const btVector3& low, const btVector3& high) override {
    send_moves();
    const btVector3 way = to - from;
    if (way.fuzzyZero()) return aabbTest(from + low, from + high, callback);
    const btScalar length = way.length();
    const btVector3 ahead = way / length;
    const winnow::BoxCast cast{
        box_of(from + low, from + high), {ahead.x(), ahead.y(), ahead.z()}, 0.0F, length};
    check(partition_.all(cast, hits_) == winnow::Status::ok, "a ray is cast");
    for (const winnow::Hit& hit : hits_) {
      if (hit.t > callback.m_lambda_max) break;
      callback.process(reinterpret_cast<const Proxy*>(hit.data));
    }
  }

  void aabbTest(const btVector3& low, const btVector3& high,
                btBroadphaseAabbCallback& callback) override {
    send_moves();
    check(partition_.overlap(box_of(low, high), inside_) == winnow::Status::ok, "a box is queried");
    for (const winnow::ObjectId id : inside_.ids()) callback.process(proxy_of(id));
  }

  void getBroadphaseAabb(btVector3& low, btVector3& high) const override {
    low = btVector3(BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT);
    high = -low;
    for (const auto& proxy : proxies_) {
      low.setMin(proxy->m_aabbMin);
      high.setMax(proxy->m_aabbMax);
    }
  }

  void printStats() override {}

 private:
  struct Proxy : btBroadphaseProxy {
    Proxy(const btVector3& low, const btVector3& high, void* user, int group, int mask)
        : btBroadphaseProxy(low, high, user, group, mask) {}
    std::size_t place = 0;
  };

  [[nodiscard]] Proxy* proxy_of(winnow::ObjectId id) const {
    return reinterpret_cast<Proxy*>(partition_.client_data_of(id));
  }
  void send_moves() {
    if (moved_.empty()) return;
    check(
        partition_.update(keys_, boxes_, winnow::IndexSubset::listed(moved_)) == winnow::Status::ok,
        "boxes move");
    moved_.clear();
  }

  winnow::Partition partition_{winnow::linear_bvh(), {.execution = winnow::Execution::serial()}};
  winnow::PairEvents events_;
  winnow::HitBuffer hits_;
  winnow::OverlapBuffer inside_;
  btHashedOverlappingPairCache pairs_;
  std::vector<std::unique_ptr<Proxy>> proxies_;
  std::vector<winnow::Key> keys_;
  std::vector<winnow::Aabb> boxes_;
  std::vector<std::uint32_t> moved_;
  int last_id_ = 0;
};

/// A world of boxes that drift, with the given broad phase.
class World {
 public:
  World(btBroadphaseInterface& broad_phase, std::size_t count)
      : broad_phase_(broad_phase),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broad_phase, &configuration_),
        side_(std::cbrt(2.0F * static_cast<float>(count))) {
    std::uniform_real_distribution<float> place(0.0F, side_);
    for (std::size_t i = 0; i < count; ++i) {
      bodies_.push_back(std::make_unique<btCollisionObject>());
      bodies_.back()->setCollisionShape(&cube_);
      bodies_.back()->getWorldTransform().setIdentity();
      bodies_.back()->getWorldTransform().setOrigin(
          {place(random_), place(random_), place(random_)});
      world_.addCollisionObject(bodies_.back().get());
    }
  }
  ~World() {
    for (const auto& body : bodies_) world_.removeCollisionObject(body.get());
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  void move() {
    std::uniform_real_distribution<float> by(-0.05F, 0.05F);
    for (const auto& body : bodies_) {
      body->getWorldTransform().getOrigin() += btVector3(by(random_), by(random_), by(random_));
    }
  }
  /// The first part of a Bullet step, before it tests shapes.
  void find_pairs() {
    world_.updateAabbs();
    world_.computeOverlappingPairs();
  }
  void remove_one() {
    world_.removeCollisionObject(bodies_.back().get());
    bodies_.pop_back();
  }

  /// Returns the pairs of bodies whose boxes overlap. Skips pairs that no longer overlap: the pair
  /// caches of winnow's broad phase and of Bullet's own may contain such pairs.
  [[nodiscard]] std::set<std::pair<int, int>> pairs() const {
    std::set<std::pair<int, int>> found;
    const btOverlappingPairCache& cache = *broad_phase_.getOverlappingPairCache();
    for (int i = 0; i < cache.getNumOverlappingPairs(); ++i) {
      const btBroadphasePair& pair = cache.getOverlappingPairArrayPtr()[i];
      if (!TestAabbAgainstAabb2(pair.m_pProxy0->m_aabbMin, pair.m_pProxy0->m_aabbMax,
                                pair.m_pProxy1->m_aabbMin, pair.m_pProxy1->m_aabbMax)) {
        continue;
      }
      found.insert(std::minmax(number_of(*pair.m_pProxy0), number_of(*pair.m_pProxy1)));
    }
    return found;
  }
  [[nodiscard]] float first_hit() const {
    const btVector3 from(-1, 0.4F * side_, 0.4F * side_);
    const btVector3 to(side_ + 1, 0.6F * side_, 0.6F * side_);
    btCollisionWorld::ClosestRayResultCallback hit(from, to);
    world_.rayTest(from, to, hit);
    return hit.m_closestHitFraction;
  }

 private:
  static int number_of(const btBroadphaseProxy& proxy) {
    return static_cast<const btCollisionObject*>(proxy.m_clientObject)->getWorldArrayIndex();
  }

  btBroadphaseInterface& broad_phase_;
  btBoxShape cube_{btVector3(0.5F, 0.5F, 0.5F)};
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btCollisionWorld world_;
  float side_;
  std::mt19937 random_{1};
  std::vector<std::unique_ptr<btCollisionObject>> bodies_;
};

/// Bullet's broad phase in its fastest setting: it searches its trees once a frame, not for each
/// box that moves.
struct BulletBroadPhase : btDbvtBroadphase {
  BulletBroadPhase() { m_deferedcollide = true; }
};

}  // namespace

int main(int argc, char** argv) {
  Race race(argc, argv);
  const std::size_t count = race.size(500, 10'000);
  WinnowBroadPhase winnow_broad_phase;
  BulletBroadPhase bullet_broad_phase;
  World with_winnow(winnow_broad_phase, count);
  World with_bullet(bullet_broad_phase, count);
  for (std::size_t frame = 0; frame < race.size(10, 30); ++frame) {
    race.time("winnow in a btCollisionWorld", [&] { with_winnow.find_pairs(); });
    race.time("btDbvtBroadphase in the same", [&] { with_bullet.find_pairs(); });
    check(with_winnow.pairs() == with_bullet.pairs(), "both find the same pairs");
    check(with_winnow.first_hit() == with_bullet.first_hit(), "a ray hits the same");
    for (World* world : {&with_winnow, &with_bullet}) {
      world->move();
      if (frame % 3 == 2) world->remove_one();
    }
  }
  return race.finish("Bullet's broad phase: " + std::to_string(count) + " boxes that all move, " +
                     std::to_string(with_winnow.pairs().size()) + " pairs, one thread each");
}
