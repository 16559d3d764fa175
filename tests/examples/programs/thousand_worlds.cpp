// A thousand small worlds, as in reinforcement learning: one scene holds all of them, each in its
// own environment, and processes them together. Compared with one scene for each world and, if
// Bullet is installed, one Bullet world for each.

#include <winnow/winnow.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#if WINNOW_BESIDE_BULLET
#include <btBulletCollisionCommon.h>
#endif

#include "tests/examples/check.h"
#include "tests/examples/programs/race.h"

namespace {

constexpr std::size_t kBodies = 24;
constexpr double kHalf = 0.25;

/// The positions of the bodies of all worlds, world by world: spheres and cubes in turn, in a heap.
class Heaps {
 public:
  explicit Heaps(std::size_t worlds) {
    std::uniform_real_distribution<double> place(-0.8, 0.8);
    for (std::size_t i = 0; i < worlds * kBodies; ++i) {
      poses.push_back(winnow::Pose::at(place(random_), place(random_), 0.8 + place(random_)));
    }
  }
  void move() {
    std::uniform_real_distribution<double> by(-0.01, 0.01);
    for (winnow::Pose& pose : poses) {
      for (double& x : pose.position) x += by(random_);
    }
  }
  static bool is_sphere(std::size_t i) { return i % 2 == 0; }

  std::vector<winnow::Pose> poses;

 private:
  std::mt19937 random_{1};
};

/// Worlds [first, first + count) in one scene.
class Worlds {
 public:
  Worlds(std::size_t first, std::size_t count)
      : first_body_(first * kBodies),
        scene_(shapes_, {.execution = winnow::Execution::serial()}),
        keys_(count * kBodies) {
    const winnow::ShapeId sphere = shapes_.add(winnow::SphereShape{kHalf});
    const winnow::ShapeId cube = shapes_.add(winnow::BoxShape{{kHalf, kHalf, kHalf}});
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      const auto world = static_cast<std::uint32_t>(i / kBodies);
      keys_[i] = scene_.add(
          {.shape = Heaps::is_sphere(i) ? sphere : cube, .filter = {.environment = world}});
      check(bool{keys_[i]}, "a body is added");
    }
  }

  void collide(const Heaps& heaps) {
    const auto poses = std::span(heaps.poses).subspan(first_body_, keys_.size());
    check(scene_.move(keys_, poses) == winnow::Status::ok, "bodies move");
    check(scene_.collide(winnow::ContactLevel::manifold, contacts_) == winnow::Status::ok,
          "contacts are found");
  }
  [[nodiscard]] std::size_t touching() const { return contacts_.size(); }

 private:
  std::size_t first_body_;
  winnow::ShapePool shapes_;
  winnow::Scene scene_;
  winnow::Contacts contacts_;
  std::vector<winnow::Key> keys_;
};

#if WINNOW_BESIDE_BULLET
class BulletWorld {
 public:
  explicit BulletWorld(std::size_t number) : first_body_(number * kBodies) {
    for (std::size_t i = 0; i < kBodies; ++i) {
      bodies_[i].setCollisionShape(Heaps::is_sphere(i) ? static_cast<btCollisionShape*>(&sphere_)
                                                       : &cube_);
      bodies_[i].getWorldTransform().setIdentity();
      world_.addCollisionObject(&bodies_[i]);
    }
  }
  ~BulletWorld() {
    for (btCollisionObject& body : bodies_) world_.removeCollisionObject(&body);
  }
  BulletWorld(const BulletWorld&) = delete;
  BulletWorld& operator=(const BulletWorld&) = delete;

  void collide(const Heaps& heaps) {
    for (std::size_t i = 0; i < kBodies; ++i) {
      const winnow::Vec3d& p = heaps.poses[first_body_ + i].position;
      bodies_[i].getWorldTransform().setOrigin(
          {static_cast<btScalar>(p[0]), static_cast<btScalar>(p[1]), static_cast<btScalar>(p[2])});
    }
    world_.performDiscreteCollisionDetection();
  }
  /// Returns the number of pairs with a touching point.
  [[nodiscard]] std::size_t touching() const {
    std::size_t count = 0;
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(i);
      bool touches = false;
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        touches = touches || manifold.getContactPoint(k).getDistance() <= 0.0F;
      }
      count += touches ? 1 : 0;
    }
    return count;
  }

 private:
  std::size_t first_body_;
  btSphereShape sphere_{static_cast<btScalar>(kHalf)};
  btBoxShape cube_{btVector3(kHalf, kHalf, kHalf)};
  btDefaultCollisionConfiguration configuration_;
  mutable btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_phase_;
  btCollisionWorld world_{&dispatcher_, &broad_phase_, &configuration_};
  std::vector<btCollisionObject> bodies_ = std::vector<btCollisionObject>(kBodies);
};
#endif

template <typename World>
std::size_t touching(const std::vector<std::unique_ptr<World>>& worlds) {
  std::size_t count = 0;
  for (const auto& world : worlds) count += world->touching();
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  Race race(argc, argv);
  const std::size_t count = race.size(20, 1'000);
  Heaps heaps(count);
  Worlds together(0, count);
  std::vector<std::unique_ptr<Worlds>> apart;
  for (std::size_t i = 0; i < count; ++i) apart.push_back(std::make_unique<Worlds>(i, 1));
#if WINNOW_BESIDE_BULLET
  std::vector<std::unique_ptr<BulletWorld>> in_bullet;
  for (std::size_t i = 0; i < count; ++i) in_bullet.push_back(std::make_unique<BulletWorld>(i));
#endif
  for (std::size_t frame = 0; frame < race.size(3, 20); ++frame) {
    race.time("winnow, one scene", [&] { together.collide(heaps); });
    race.time("winnow, a scene a world", [&] {
      for (const auto& world : apart) world->collide(heaps);
    });
    check(together.touching() == touching(apart), "each world has its own contacts");
#if WINNOW_BESIDE_BULLET
    race.time("Bullet, a btCollisionWorld a world", [&] {
      for (const auto& world : in_bullet) world->collide(heaps);
    });
    const double share =
        static_cast<double>(touching(in_bullet)) / static_cast<double>(together.touching());
    check(std::abs(share - 1.0) < 0.02, "Bullet finds as many pairs");
#endif
    heaps.move();
  }
  return race.finish(std::to_string(count) + " worlds of " + std::to_string(kBodies) +
                     " bodies, contacts with manifolds, " + std::to_string(together.touching()) +
                     " pairs touch, one thread each");
}
