// Projectiles, ships and shields: candidate hits of each shot in a step, the exact hits, and events
// for shots that enter and leave shields. The box of a shot covers its whole step, so that a fast
// shot cannot pass through a ship. Compared, if Bullet is installed, with btDbvtBroadphase, which
// has no events.

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#if WINNOW_BESIDE_BULLET
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#endif

#include "tests/examples/check.h"
#include "tests/examples/programs/race.h"

namespace {

enum Layer : std::uint32_t { kShip = 1, kShot = 2, kShield = 4 };

/// Shots collide with ships and shields; objects of one kind do not collide.
winnow::ObjectFilter filter_of(Layer layer) {
  return {.layers = layer, .mask = layer == kShot ? kShip | kShield : kShot};
}

struct Hit {
  std::uint32_t shot;
  std::uint32_t ship;
  friend auto operator<=>(const Hit&, const Hit&) = default;
};

/// All flying objects: ships, then shields, then shots. Ships and shields are balls, shots are
/// segments.
class Battle {
 public:
  Battle(std::size_t ships, std::size_t shields, std::size_t shots)
      : side_(6.0F * std::cbrt(static_cast<float>(ships))), first_shot_(ships + shields) {
    for (std::size_t i = 0; i < ships; ++i) add(kShip, 0.5F, 0.02F);
    for (std::size_t i = 0; i < shields; ++i) add(kShield, 6.0F, 0.0F);
    for (std::size_t i = 0; i < shots; ++i) add(kShot, 0.0F, 3.0F);
  }

  void step() {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      position_[i] += velocity_[i];
      boxes[i] = box_of(i);
    }
  }
  /// Returns whether the segment of a shot touches a ship.
  [[nodiscard]] bool hits(std::uint32_t shot, std::uint32_t ship) const {
    const winnow::Vec3f way = velocity_[shot];
    const winnow::Vec3f to_ship = position_[ship] - position_[shot];
    const float t = std::clamp(to_ship.dot(way) / way.squared_norm(), 0.0F, 1.0F);
    return (to_ship - t * way).squared_norm() <= radius_[ship] * radius_[ship];
  }
  /// Fires a shot again after it has hit a ship or left the world.
  void fire(std::uint32_t shot) {
    position_[shot] = any_place();
    boxes[shot] = box_of(shot);
  }
  /// Returns the shots that end with this step, each once.
  [[nodiscard]] std::vector<std::uint32_t> gone(std::span<const Hit> found) const {
    std::vector<std::uint32_t> shots;
    for (const Hit& hit : found) shots.push_back(hit.shot);
    for (std::size_t i = first_shot_; i < boxes.size(); ++i) {
      const winnow::Vec3f& p = position_[i];
      const auto outside = [&](float at) { return at < 0.0F || at > side_; };
      if (outside(p.x()) || outside(p.y()) || outside(p.z())) {
        shots.push_back(static_cast<std::uint32_t>(i));
      }
    }
    std::ranges::sort(shots);
    shots.erase(std::unique(shots.begin(), shots.end()), shots.end());
    return shots;
  }

  std::vector<winnow::Aabb> boxes;
  std::vector<Layer> layers;

 private:
  winnow::Vec3f any_place() {
    std::uniform_real_distribution<float> place(0.0F, side_);
    return {place(random_), place(random_), place(random_)};
  }
  void add(Layer layer, float radius, float speed) {
    std::normal_distribution<float> way;
    const winnow::Vec3f ahead(way(random_), way(random_), way(random_));
    position_.push_back(any_place());
    velocity_.push_back(speed / ahead.norm() * ahead);
    radius_.push_back(radius);
    layers.push_back(layer);
    boxes.push_back(box_of(boxes.size()));
  }
  [[nodiscard]] winnow::Aabb box_of(std::size_t i) const {
    const winnow::Vec3f from = position_[i];
    const winnow::Vec3f to = layers[i] == kShot ? from + velocity_[i] : from;
    const winnow::Vec3f around = winnow::Vec3f::constant(radius_[i]);
    return {from.min(to) - around, from.max(to) + around};
  }

  float side_;
  std::size_t first_shot_;
  std::mt19937 random_{1};
  std::vector<winnow::Vec3f> position_;
  std::vector<winnow::Vec3f> velocity_;
  std::vector<float> radius_;
};

class WinnowFinder {
 public:
  explicit WinnowFinder(const Battle& battle) : keys_(battle.boxes.size()) {
    for (std::uint32_t i = 0; i < keys_.size(); ++i) add(battle, i);
  }

  void find_hits(const Battle& battle, std::vector<Hit>& hits) {
    check(partition_.update(keys_, battle.boxes) == winnow::Status::ok, "all move");
    check(partition_.self_pairs(pairs_, events_) == winnow::Status::ok, "pairs are found");
    hits.clear();
    for (const winnow::Pair& pair : pairs_) {
      const std::uint32_t shot = shot_of(battle, pair.first, pair.second);
      const std::uint32_t other =
          shot == number_of(pair.first) ? number_of(pair.second) : number_of(pair.first);
      if (battle.layers[other] == kShip && battle.hits(shot, other)) hits.push_back({shot, other});
    }
    for (const winnow::KeyPair& pair : events_.begun()) count(battle, pair, entered);
    for (const winnow::KeyPair& pair : events_.ended()) {
      // A pair also ends if an object is removed; its key is then no longer valid.
      if (!partition_.contains(pair.first) || !partition_.contains(pair.second)) {
        ++gone;
      } else {
        count(battle, pair, left);
      }
    }
  }

  void replace(const Battle& battle, std::uint32_t shot) {
    check(partition_.remove(keys_[shot]) == winnow::Status::ok, "a shot is removed");
    add(battle, shot);
  }

  /// Number of shots that entered and left shields, and of pairs that ended with their shot.
  std::size_t entered = 0;
  std::size_t left = 0;
  std::size_t gone = 0;

 private:
  void add(const Battle& battle, std::uint32_t i) {
    keys_[i] = partition_.insert(battle.boxes[i], i);
    check(partition_.set_filter(keys_[i], filter_of(battle.layers[i])) == winnow::Status::ok,
          "it gets a filter");
  }
  [[nodiscard]] std::uint32_t number_of(winnow::ObjectId id) const {
    return static_cast<std::uint32_t>(partition_.client_data_of(id));
  }
  [[nodiscard]] std::uint32_t shot_of(const Battle& battle, winnow::ObjectId a,
                                      winnow::ObjectId b) const {
    return battle.layers[number_of(a)] == kShot ? number_of(a) : number_of(b);
  }
  void count(const Battle& battle, const winnow::KeyPair& pair, std::size_t& events) const {
    const Layer one = battle.layers[number_of(pair.first.id)];
    const Layer other = battle.layers[number_of(pair.second.id)];
    events += one == kShield || other == kShield ? 1 : 0;
  }

  winnow::Partition partition_{winnow::linear_bvh(), {.execution = winnow::Execution::serial()}};
  winnow::PairBuffer pairs_;
  winnow::PairEvents events_;
  std::vector<winnow::Key> keys_;
};

#if WINNOW_BESIDE_BULLET
class BulletFinder {
 public:
  explicit BulletFinder(const Battle& battle) : proxies_(battle.boxes.size()) {
    broad_phase_.m_deferedcollide = true;
    for (std::uint32_t i = 0; i < proxies_.size(); ++i) add(battle, i);
  }
  ~BulletFinder() {
    for (btBroadphaseProxy* proxy : proxies_) broad_phase_.destroyProxy(proxy, nullptr);
  }
  BulletFinder(const BulletFinder&) = delete;
  BulletFinder& operator=(const BulletFinder&) = delete;

  void find_hits(const Battle& battle, std::vector<Hit>& hits) {
    for (std::size_t i = 0; i < proxies_.size(); ++i) {
      broad_phase_.setAabb(proxies_[i], low(battle, i), high(battle, i), nullptr);
    }
    broad_phase_.calculateOverlappingPairs(nullptr);
    hits.clear();
    const btOverlappingPairCache& cache = *broad_phase_.getOverlappingPairCache();
    for (int i = 0; i < cache.getNumOverlappingPairs(); ++i) {
      const btBroadphasePair& pair = cache.getOverlappingPairArrayPtr()[i];
      std::uint32_t shot = number_of(*pair.m_pProxy0);
      std::uint32_t other = number_of(*pair.m_pProxy1);
      if (battle.layers[shot] != kShot) std::swap(shot, other);
      if (battle.layers[other] == kShip && battle.hits(shot, other)) hits.push_back({shot, other});
    }
  }

  void replace(const Battle& battle, std::uint32_t shot) {
    broad_phase_.destroyProxy(proxies_[shot], nullptr);
    add(battle, shot);
  }

 private:
  static btVector3 low(const Battle& battle, std::size_t i) {
    const winnow::Vec3f& p = battle.boxes[i].min;
    return {p.x(), p.y(), p.z()};
  }
  static btVector3 high(const Battle& battle, std::size_t i) {
    const winnow::Vec3f& p = battle.boxes[i].max;
    return {p.x(), p.y(), p.z()};
  }
  static std::uint32_t number_of(const btBroadphaseProxy& proxy) {
    return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(proxy.m_clientObject));
  }
  void add(const Battle& battle, std::uint32_t i) {
    const winnow::ObjectFilter filter = filter_of(battle.layers[i]);
    proxies_[i] = broad_phase_.createProxy(
        low(battle, i), high(battle, i), 0, reinterpret_cast<void*>(std::uintptr_t{i}),
        static_cast<int>(filter.layers), static_cast<int>(filter.mask), nullptr);
  }

  btDbvtBroadphase broad_phase_;
  std::vector<btBroadphaseProxy*> proxies_;
};
#endif

/// Tests every shot against every ship.
std::vector<Hit> all_hits(const Battle& battle) {
  std::vector<Hit> hits;
  for (std::uint32_t shot = 0; shot < battle.boxes.size(); ++shot) {
    if (battle.layers[shot] != kShot) continue;
    for (std::uint32_t ship = 0; battle.layers[ship] == kShip; ++ship) {
      if (battle.hits(shot, ship)) hits.push_back({shot, ship});
    }
  }
  return hits;
}

}  // namespace

int main(int argc, char** argv) {
  Race race(argc, argv);
  const std::size_t ships = race.size(500, 20'000);
  const std::size_t shots = race.size(200, 4'000);
  Battle battle(ships, ships / 100, shots);
  WinnowFinder winnow_finder(battle);
  std::vector<Hit> hits;
  std::size_t total = 0;
#if WINNOW_BESIDE_BULLET
  BulletFinder bullet_finder(battle);
  std::vector<Hit> of_bullet;
#endif
  for (std::size_t frame = 0; frame < race.size(20, 50); ++frame) {
    battle.step();
    race.time("winnow, with events", [&] { winnow_finder.find_hits(battle, hits); });
    std::ranges::sort(hits);
    total += hits.size();
    check(frame % 10 != 0 || hits == all_hits(battle), "hits equal the hits of all pairs");
#if WINNOW_BESIDE_BULLET
    race.time("btDbvtBroadphase, without", [&] { bullet_finder.find_hits(battle, of_bullet); });
    std::ranges::sort(of_bullet);
    check(hits == of_bullet, "Bullet finds the same hits");
#endif
    for (const std::uint32_t shot : battle.gone(hits)) {
      battle.fire(shot);
      winnow_finder.replace(battle, shot);
#if WINNOW_BESIDE_BULLET
      bullet_finder.replace(battle, shot);
#endif
    }
  }
  check(total != 0 && winnow_finder.entered != 0 && winnow_finder.left != 0, "there were events");
  return race.finish("projectiles: " + std::to_string(shots) + " shots at " +
                     std::to_string(ships) + " ships, " + std::to_string(total) + " hits, " +
                     std::to_string(winnow_finder.entered) + " shots into shields and " +
                     std::to_string(winnow_finder.left) + " out of them, one thread each");
}
