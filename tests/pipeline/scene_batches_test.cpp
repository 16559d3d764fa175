// Scenes with more pairs and more bodies than one internal batch holds; pairs that are rejected by
// bounding balls; and the memory that this saves.

#include <gtest/gtest.h>
#include <winnow/pipeline/composite_pool.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "tests/pipeline/scene_world.h"
#include "tests/support/answers.h"
#include "tests/support/counting_memory.h"
#include "tests/support/meshes.h"

namespace winnow::test {
namespace {

/// More than two batches of pairs of a scene.
constexpr std::size_t kManyPairs = 70000;

/// Bodies that nearly all overlap each other, some of them meshes.
class DenseWorld {
 public:
  DenseWorld() : world_(400, 77), composites_(world_.pool) {
    ShapeId mesh;
    const MeshData data = torus(7, 5);
    mesh = expect_ok(composites_.add_mesh(data.points(), data.indices()));
    for (std::size_t i = 0; i < world_.bodies.size(); ++i) {
      BodyDefinition& body = world_.bodies[i];
      body.state = BodyState::dynamic;
      body.filter = {};
      if (i % 40 == 0) body.shape = mesh;
    }
    squeeze();
  }

  /// If ghost contacts are suppressed, a scene solves all pairs in one batch. No body here is
  /// fixed, so the option changes nothing else.
  [[nodiscard]] SceneOptions options(bool at_once) const {
    return {.suppress_ghost_contacts = at_once, .warm_start = true, .composites = &composites_};
  }
  [[nodiscard]] SceneWorld& world() { return world_; }
  void stir() {
    world_.stir(0.05);
    squeeze();
  }

 private:
  void squeeze() {
    for (BodyDefinition& body : world_.bodies) {
      for (double& p : body.pose.position) p = std::fmod(std::abs(p), 0.7);
    }
  }

  SceneWorld world_;
  CompositePool composites_;
};

void expect_batches_are_what_is_answered_at_once(ContactLevel level, double cache_tolerance) {
  DenseWorld dense;
  SceneOptions batches = dense.options(false);
  SceneOptions at_once = dense.options(true);
  batches.cache_tolerance = at_once.cache_tolerance = cache_tolerance;
  Scene one(dense.world().pool, batches);
  Scene other(dense.world().pool, at_once);
  Contacts of_one;
  Contacts of_other;
  SceneWorld& world = dense.world();
  std::vector<Key> keys(world.bodies.size());
  ASSERT_EQ(one.add(world.bodies, keys), Status::ok);
  std::vector<Key> other_keys(world.bodies.size());
  ASSERT_EQ(other.add(world.bodies, other_keys), Status::ok);
  for (int frame = 0; frame < 2; ++frame) {
    ASSERT_EQ(one.collide(level, of_one), Status::ok);
    ASSERT_EQ(other.collide(level, of_other), Status::ok);
    ASSERT_GT(one.statistics().body_pairs - one.statistics().rejected_by_spheres, kManyPairs);
    ASSERT_EQ(digest(of_one), digest(of_other)) << frame;
    ASSERT_EQ(of_one.ended().size(), of_other.ended().size());
    dense.stir();
    for (std::size_t i = 0; i < keys.size(); i += 3) {
      ASSERT_EQ(one.move(keys[i], world.bodies[i].pose), Status::ok);
      ASSERT_EQ(other.move(other_keys[i], world.bodies[i].pose), Status::ok);
    }
  }
}

TEST(SceneBatches, batches_match_one_pass) {
  expect_batches_are_what_is_answered_at_once(ContactLevel::boolean, 0.0);
  expect_batches_are_what_is_answered_at_once(ContactLevel::manifold, 0.0);
  expect_batches_are_what_is_answered_at_once(ContactLevel::distance, 0.2);
}

TEST(SceneBatches, previous_pair_is_right_across_batches) {
  DenseWorld dense;
  SceneWorld& world = dense.world();
  Scene scene(world.pool, dense.options(false));
  Contacts contacts;
  ASSERT_EQ(scene.add(world.bodies, world.keys), Status::ok);
  ASSERT_EQ(scene.collide(ContactLevel::boolean, contacts), Status::ok);
  std::map<std::pair<ObjectId, ObjectId>, std::uint32_t> before;
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    before[{contacts.a()[i].id, contacts.b()[i].id}] = i;
  }
  dense.stir();
  ASSERT_EQ(move_all(scene, world), Status::ok);
  ASSERT_EQ(scene.collide(ContactLevel::boolean, contacts), Status::ok);
  std::size_t persisted = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto was = before.find({contacts.a()[i].id, contacts.b()[i].id});
    EXPECT_EQ(contacts.previous_pair()[i], was == before.end() ? kNoContact : was->second);
    EXPECT_EQ(contacts.event()[i],
              was == before.end() ? ContactEvent::begun : ContactEvent::persisted);
    persisted += was == before.end() ? 0 : 1;
  }
  EXPECT_EQ(contacts.ended().size(), before.size() - persisted);
  EXPECT_GT(persisted, 0U);
  EXPECT_GT(contacts.ended().size(), 0U);
}

/// More than two batches of bodies.
constexpr std::size_t kManyBodies = 40000;
constexpr BodyState kBodyStateOf[] = {BodyState::fixed, BodyState::dynamic, BodyState::sleeping};

/// Rows of balls. Each touches its neighbours in the row.
class Rows {
 public:
  Rows() {
    ShapeId ball = expect_ok(pool.add(SphereShape{0.5}));
    for (std::size_t i = 0; i < kManyBodies; ++i) {
      BodyDefinition body{.shape = ball, .data = 7 * i};
      body.pose =
          Pose::at(0.99 * static_cast<double>(i % 200), 2.0 * static_cast<double>(i / 200), 0.0);
      bodies.push_back(body);
    }
  }

  ShapePool pool;
  std::vector<BodyDefinition> bodies;
};

TEST(SceneBatches, moving_many_bodies_matches_fresh_scene) {
  Rows rows;
  CountingMemory memory;
  Scene scene(rows.pool, {.memory = &memory});
  Contacts contacts;
  std::vector<Key> keys(kManyBodies);
  ASSERT_EQ(scene.add(rows.bodies, keys), Status::ok);
  EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
  std::vector<Pose> poses(kManyBodies);
  // In the first step some contacts end and the bodies stay near their old positions. In the second
  // step all bodies move far away.
  for (const double far : {0.0, 1e6}) {
    for (std::size_t i = 0; i < kManyBodies; ++i) {
      Pose& pose = rows.bodies[i].pose;
      pose.position[1] += 0.1 * static_cast<double>((i + (far > 0.0 ? 1 : 0)) % 3);
      pose.position[2] = far;
      poses[i] = pose;
    }
    ASSERT_EQ(scene.move(keys, poses), Status::ok);
    ASSERT_EQ(scene.collide(ContactLevel::distance, contacts), Status::ok);
    Scene fresh(rows.pool, {});
    Contacts expected;
    std::vector<Key> fresh_keys(kManyBodies);
    ASSERT_EQ(fresh.add(rows.bodies, fresh_keys), Status::ok);
    ASSERT_EQ(fresh.collide(ContactLevel::distance, expected), Status::ok);
    ASSERT_GT(contacts.size(), kManyBodies / 4);
    ASSERT_LT(contacts.size(), kManyBodies);
    EXPECT_TRUE(std::ranges::equal(contacts.data_a(), expected.data_a()));
    EXPECT_TRUE(std::ranges::equal(contacts.data_b(), expected.data_b()));
    EXPECT_TRUE(std::ranges::equal(contacts.distance(), expected.distance()));
    EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
  }
}

TEST(SceneBatches, removing_many_bodies_keeps_the_others) {
  Rows rows;
  for (std::size_t i = 0; i < kManyBodies; ++i) rows.bodies[i].state = kBodyStateOf[i % 3];
  Scene scene(rows.pool, {});
  Contacts contacts;
  std::vector<Key> keys(kManyBodies);
  ASSERT_EQ(scene.add(rows.bodies, keys), Status::ok);
  std::vector<Key> leaving;
  for (std::size_t i = 0; i < kManyBodies; i += 2) leaving.push_back(keys[i]);
  ASSERT_EQ(scene.remove(leaving), Status::ok);
  EXPECT_EQ(scene.size(), kManyBodies / 2);
  for (std::size_t i = 0; i < kManyBodies; ++i) EXPECT_EQ(scene.contains(keys[i]), i % 2 == 1);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(static_cast<double>(scene.size(kBodyStateOf[i])), kManyBodies / 6.0, 1.0);
  }
  ASSERT_EQ(scene.collide(ContactLevel::pairs, contacts), Status::ok);
  EXPECT_EQ(contacts.size(), 0U);
}

// A contact at this level takes 85 bytes of results, and 8 more if the scene has composite shapes.
// The remaining bytes belong to bodies, pairs and partitions.
TEST(SceneBatches, contact_takes_few_bytes) {
  ShapePool pool;
  ShapeId ball = expect_ok(pool.add(SphereShape{0.5}));
  Random random(5);
  std::vector<BodyDefinition> bodies(30000, BodyDefinition{.shape = ball});
  const double side = std::cbrt(static_cast<double>(bodies.size()) * 0.29);
  for (BodyDefinition& body : bodies) {
    for (double& p : body.pose.position) p = random.uniform(0.0, side);
  }
  bodies.back().pose = Pose::at(-50.0, 0.0, 0.0);
  CompositePool composites(pool);
  const MeshData data = torus(7, 5);
  ShapeId mesh = expect_ok(composites.add_mesh(data.points(), data.indices()));
  std::size_t results[2];
  for (int with = 0; with < 2; ++with) {
    CountingMemory memory;
    Scene scene(pool,
                {.memory = &memory, .execution = Execution::serial(), .composites = &composites});
    Contacts contacts(&memory);
    bodies.back().shape = with == 1 ? mesh : ball;
    std::vector<Key> keys(bodies.size());
    ASSERT_EQ(scene.add(bodies, keys), Status::ok);
    for (int frame = 0; frame < 3; ++frame) {
      ASSERT_EQ(scene.move(keys[0], bodies[0].pose), Status::ok);
      ASSERT_EQ(scene.collide(ContactLevel::distance, contacts), Status::ok);
    }
    ASSERT_GT(contacts.size(), 6 * bodies.size());
    EXPECT_EQ(scene.footprint().total().reserved + contacts.footprint().total().reserved,
              memory.outstanding());
    EXPECT_LT(memory.outstanding(), (with == 0 ? 170 : 178) * contacts.size());
    results[with] = contacts.footprint().results.used / contacts.size();
    EXPECT_TRUE(std::ranges::all_of(contacts.part_a(),
                                    [](std::uint32_t part) { return part == kWholeShape; }));
    EXPECT_EQ(contacts.part_b().size(), contacts.size());
  }
  EXPECT_EQ(results[0], 85U);
  EXPECT_EQ(results[1], 93U);
}

/// Size of the bodies and their offset from the origin.
struct Place {
  double size;
  double offset;
};

/// Returns spheres and capsules in a cube of ten sizes. Some pairs touch exactly, because half of
/// the bodies are on a raster of a quarter of the size.
[[nodiscard]] std::vector<BodyDefinition> bodies_at(const Place& place, ShapePool& pool,
                                                    Random& random) {
  std::array<ShapeId, 3> shapes;
  shapes[0] = expect_ok(pool.add(SphereShape{place.size}));
  shapes[1] = expect_ok(pool.add(SphereShape{0.25 * place.size}));
  shapes[2] = expect_ok(pool.add(CapsuleShape{0.5 * place.size, place.size}));
  std::vector<BodyDefinition> bodies(200);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].shape = shapes[i % shapes.size()];
    for (double& p : bodies[i].pose.position) {
      const double steps = std::floor(random.uniform(0.0, 40.0)) * 0.25;
      const double wobble = i % 2 == 0 ? 0.0 : random.uniform(-1e-7, 1e-7);
      p = place.offset + (steps + wobble) * place.size;
    }
  }
  return bodies;
}

TEST(SceneBoundingBalls, bounding_balls_reject_no_contact) {
  Random random(91);
  for (const Place& place : {Place{1.0, 0.0}, Place{1.0, 1e9}, Place{1e-3, 1e3}, Place{1e-18, 0.0},
                             Place{1e-25, 0.0}, Place{1e15, -1e17}}) {
    for (const double share : {0.0, 0.3}) {
      ShapePool pool;
      std::vector<BodyDefinition> bodies = bodies_at(place, pool, random);
      if (share > 0.0) bodies[0].offsets = {place.size, 0.0};
      Scene scene(pool, {.contact_margin = share * place.size});
      std::vector<Key> keys(bodies.size());
      ASSERT_EQ(scene.add(bodies, keys), Status::ok);
      Contacts near;
      ASSERT_EQ(scene.collide(ContactLevel::pairs, near), Status::ok);
      EXPECT_EQ(scene.statistics().rejected_by_spheres, 0U);
      std::vector<ShapeId> shapes;
      std::vector<Pose> poses;
      for (const BodyDefinition& body : bodies) {
        shapes.push_back(body.shape);
        poses.push_back(body.pose);
      }
      std::vector<BodyPair> pairs;
      for (std::size_t i = 0; i < near.size(); ++i) {
        pairs.push_back({near.a()[i].id, near.b()[i].id});
      }
      NarrowPhase narrow;
      NarrowResult answers;
      ASSERT_EQ(
          narrow.collide(pool, {shapes, poses}, pairs, {.level = ContactLevel::distance}, answers),
          Status::ok);
      std::set<std::pair<ObjectId, ObjectId>> expected;
      for (std::size_t i = 0; i < answers.size(); ++i) {
        const BodyPair& pair = pairs[answers.pair_of(i)];
        const bool is_wide = share > 0.0 && (pair.a == 0 || pair.b == 0);
        const double gap = share * place.size + (is_wide ? place.size : 0.0);
        if (answers.distance()[i] <= gap) expected.insert({pair.a, pair.b});
      }
      Contacts contacts;
      ASSERT_EQ(scene.collide(ContactLevel::distance, contacts), Status::ok);
      std::set<std::pair<ObjectId, ObjectId>> shown;
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        shown.insert({contacts.a()[i].id, contacts.b()[i].id});
      }
      EXPECT_EQ(shown, expected) << place.size << ", " << place.offset;
      EXPECT_EQ(scene.statistics().body_pairs, near.size());
      if (place.size >= 1e-3) {
        EXPECT_GT(scene.statistics().rejected_by_spheres, 0U);
      }
    }
  }
}

}  // namespace
}  // namespace winnow::test
