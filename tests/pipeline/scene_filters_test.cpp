// Filters of pairs in scenes (ignored pairs, predicate, layers), and moves by positions without
// orientations.

#include "tests/pipeline/scene_world.h"

#include <gtest/gtest.h>
#include <winnow/pipeline/sensors.h>

#include <algorithm>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

/// Four balls in a row. Each touches the next.
struct Row {
  Row() {
    ShapeId ball = expect_ok(pool.add(SphereShape{1.0}));
    for (int i = 0; i < 4; ++i) {
      const BodyDefinition body{
          .shape = ball, .pose = Pose::at(1.9 * i, 0, 0), .data = static_cast<ClientData>(i)};
      keys[i] = expect_ok(scene.add(body));
    }
  }
  [[nodiscard]] std::set<Names> pairs() {
    EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    return shown(contacts);
  }

  ShapePool pool;
  Scene scene{pool, {.cache_tolerance = 0.01}};
  Key keys[4];
  Contacts contacts;
};

using Pairs = std::set<Names>;

TEST(SceneFilters, ignored_pair_ends_until_it_is_restored) {
  Row row;
  EXPECT_EQ(row.pairs(), (Pairs{{0, 1}, {1, 2}, {2, 3}}));
  ASSERT_EQ(row.scene.set_ignored(row.keys[2], row.keys[1]), Status::ok);
  EXPECT_TRUE(row.scene.is_ignored(row.keys[1], row.keys[2]));
  EXPECT_EQ(row.pairs(), (Pairs{{0, 1}, {2, 3}}));
  EXPECT_EQ(row.contacts.ended().size(), 1U);
  ASSERT_EQ(row.scene.set_body_state(row.keys[1], BodyState::sleeping), Status::ok);
  EXPECT_EQ(row.pairs(), (Pairs{{0, 1}, {2, 3}}));
  ASSERT_EQ(row.scene.set_ignored(row.keys[1], row.keys[2], false), Status::ok);
  EXPECT_FALSE(row.scene.is_ignored(row.keys[1], row.keys[2]));
  EXPECT_EQ(row.pairs(), (Pairs{{0, 1}, {1, 2}, {2, 3}}));
}

TEST(SceneFilters, removed_body_loses_its_ignored_pairs) {
  Row row;
  ASSERT_EQ(row.scene.set_ignored(row.keys[0], row.keys[1]), Status::ok);
  BodyDefinition body = expect_ok(row.scene.body(row.keys[0]));
  ASSERT_EQ(row.scene.remove(row.keys[0]), Status::ok);
  EXPECT_EQ(row.scene.set_ignored(row.keys[0], row.keys[2]), Status::invalid_key);
  Key fresh = expect_ok(row.scene.add(body));
  ASSERT_EQ(fresh.id, row.keys[0].id);
  EXPECT_EQ(row.pairs(), (Pairs{{0, 1}, {1, 2}, {2, 3}}));
  EXPECT_EQ(row.scene.set_ignored(fresh, fresh), Status::invalid_argument);
}

/// Changes ignored pairs in random order and keeps the expected set.
struct RandomIgnores {
  static constexpr std::size_t kBodies = 25;

  RandomIgnores() {
    ball = expect_ok(pool.add(SphereShape{1.0}));
    for (Key& key : keys) key = scene.add({.shape = ball});
  }
  void set_random(bool ignored) {
    std::vector<KeyPair> changed;
    for (std::size_t i = random.below(12); i > 0; --i) {
      const std::size_t a = random.below(kBodies);
      const std::size_t b = (a + 1 + random.below(kBodies - 1)) % kBodies;
      changed.push_back({keys[a], keys[b]});
      if (ignored) {
        truth.insert(names(a, b));
      } else {
        truth.erase(names(a, b));
      }
    }
    ASSERT_EQ(scene.set_ignored(changed, ignored), Status::ok);
  }
  void replace() {
    const std::size_t body = random.below(kBodies);
    ASSERT_EQ(scene.remove(keys[body]), Status::ok);
    keys[body] = scene.add({.shape = ball});
    std::erase_if(truth,
                  [&](const Names& pair) { return pair.first == body || pair.second == body; });
  }

  ShapePool pool;
  ShapeId ball;
  Scene scene{pool};
  Key keys[kBodies];
  Pairs truth;
  Random random{3};
};

TEST(SceneFilters, ignored_pairs_match_set_in_any_order) {
  RandomIgnores ignores;
  for (std::size_t step = 0; step < scaled(200); ++step) {
    ignores.set_random(ignores.random.chance(0.7));
    if (ignores.random.chance(0.2)) ignores.replace();
    if (ignores.random.chance(0.02)) {
      ignores.scene.clear();
      for (Key& key : ignores.keys) key = ignores.scene.add({.shape = ignores.ball});
      ignores.truth.clear();
    }
    for (std::size_t a = 0; a < RandomIgnores::kBodies; ++a) {
      for (std::size_t b = a + 1; b < RandomIgnores::kBodies; ++b) {
        EXPECT_EQ(ignores.scene.is_ignored(ignores.keys[b], ignores.keys[a]),
                  ignores.truth.contains(names(a, b)));
      }
    }
  }
}

TEST(SceneFilters, predicate_receives_body_ids) {
  Row row;
  ObjectId lone = row.keys[2].id;
  row.scene.set_predicate({[](void* context, ObjectId a, ObjectId b) {
                             const ObjectId never = *static_cast<ObjectId*>(context);
                             return a != never && b != never;
                           },
                           &lone});
  EXPECT_EQ(row.pairs(), (Pairs{{0, 1}}));
  lone = row.keys[0].id;
  row.scene.set_predicate({[](void* context, ObjectId a, ObjectId b) {
                             const ObjectId never = *static_cast<ObjectId*>(context);
                             return a != never && b != never;
                           },
                           &lone});
  EXPECT_EQ(row.pairs(), (Pairs{{1, 2}, {2, 3}}));
  row.scene.set_predicate({});
  EXPECT_EQ(row.pairs(), (Pairs{{0, 1}, {1, 2}, {2, 3}}));
}

/// Pairs are ignored and restored at random while bodies move.
TEST(SceneFilters, contacts_leave_out_ignored_pairs) {
  SceneWorld world(scaled(300), 31);
  Scene scene(world.pool);
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  std::set<Names> ignored;
  for (int frame = 0; frame < 10; ++frame) {
    std::vector<KeyPair> changed;
    const bool heed = frame % 3 == 2;
    const auto truth = world.touching();
    for (const auto& [pair, distance] : truth) {
      if (world.random.chance(0.7)) continue;
      changed.push_back({world.key(pair.first), world.key(pair.second)});
      if (heed) {
        ignored.erase(pair);
      } else {
        ignored.insert(pair);
      }
    }
    ASSERT_EQ(scene.set_ignored(changed, !heed), Status::ok);
    ASSERT_EQ(scene.collide(ContactLevel::boolean, contacts), Status::ok);
    std::set<Names> expected;
    for (const auto& [pair, distance] : truth) {
      if (ignored.count(pair) == 0) expected.insert(pair);
    }
    EXPECT_EQ(shown(contacts), expected);
    world.stir(0.02);
    ASSERT_EQ(move_all(scene, world), Status::ok);
  }
}

/// Hundreds of layers with random rules, while bodies change their layer.
TEST(SceneFilters, contacts_leave_out_pairs_of_excluded_layers) {
  CountingMemory memory;
  SceneWorld world(scaled(300), 34);
  Scene scene(world.pool, {.memory = &memory});
  ASSERT_EQ(add_all(scene, world), Status::ok);
  EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
  std::set<std::pair<std::uint16_t, std::uint16_t>> apart;
  Contacts contacts;
  for (int frame = 0; frame < 8; ++frame) {
    // Use higher and higher layers, so that the table of rules grows.
    const std::uint32_t layers = frame < 2 ? 3U : 40U << frame;
    for (std::size_t i = 0; i < world.keys.size(); ++i) {
      world.bodies[i].layer = static_cast<std::uint16_t>(
          std::min<std::size_t>(4095, world.random.chance(0.5) ? i % 7 : i * 13 % layers));
      ASSERT_EQ(scene.set_layer(world.keys[i], world.bodies[i].layer), Status::ok);
    }
    for (const auto& [pair, distance] : world.touching()) {
      const std::uint16_t a = world.body(pair.first).layer;
      const std::uint16_t b = world.body(pair.second).layer;
      const bool collide = world.random.chance(0.6);
      ASSERT_EQ(scene.set_layers_collide(b, a, collide), Status::ok);
      EXPECT_EQ(scene.layers_collide(a, b), collide);
      for (const auto& changed : {std::pair(a, b), std::pair(b, a)}) {
        if (collide) {
          apart.erase(changed);
        } else {
          apart.insert(changed);
        }
      }
    }
    ASSERT_EQ(scene.collide(ContactLevel::boolean, contacts), Status::ok);
    std::set<Names> expected;
    for (const auto& [pair, distance] : world.touching()) {
      const auto layers_of = std::pair(world.body(pair.first).layer, world.body(pair.second).layer);
      if (apart.count(layers_of) == 0) expected.insert(pair);
    }
    EXPECT_EQ(shown(contacts), expected);
    EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
  }
  BodyDefinition body = expect_ok(scene.body(world.keys[5]));
  EXPECT_EQ(body.layer, world.bodies[5].layer);
}

TEST(SceneFilters, ray_skips_layers_and_ignored_body) {
  Row row;
  ASSERT_EQ(row.scene.set_layer(row.keys[0], 300), Status::ok);
  ASSERT_EQ(row.scene.set_layer(row.keys[1], 4095), Status::ok);
  ASSERT_EQ(row.scene.set_layers_collide(300, 7, false), Status::ok);
  ASSERT_EQ(row.scene.refresh(), Status::ok);
  SceneQueries queries(row.scene);
  const ShapeRay ray{{-5, 0, 0}, {1, 0, 0}, 0, 100};
  EXPECT_EQ(expect_ok(queries.closest(ray)).key, row.keys[0]);
  SceneFilter filter{.layer = 7};
  EXPECT_EQ(expect_ok(queries.closest(ray, filter)).key, row.keys[1]);
  filter.ignored = row.keys[1];
  EXPECT_EQ(expect_ok(queries.closest(ray, filter)).key, row.keys[2]);
  ObjectId never = row.keys[2].id;
  filter.predicate = {
      [](void* context, Key key, ClientData) { return key.id != *static_cast<ObjectId*>(context); },
      &never};
  EXPECT_FALSE(expect_ok(queries.closest(ray, filter)).key == row.keys[2]);
  // A stale key ignores nothing.
  EXPECT_EQ(expect_ok(queries.closest(ray, {.ignored = {row.keys[0].id, 1}})).key, row.keys[0]);
}

TEST(SceneFilters, sensors_skip_layers) {
  Row row;
  ASSERT_EQ(row.scene.set_layer(row.keys[0], 300), Status::ok);
  ASSERT_EQ(row.scene.set_layers_collide(300, 7, false), Status::ok);
  const BodyDefinition body = expect_ok(row.scene.body(row.keys[0]));
  Sensors sensors(row.scene);
  SensorDefinition sensor{.shape = body.shape, .pose = body.pose};
  const auto senses = [&](Key key) {
    return std::ranges::any_of(sensors.sensed(), [&](const auto& in) { return in.body == key; });
  };
  const Key any = expect_ok(sensors.add(sensor));
  ASSERT_EQ(sensors.sense(), Status::ok);
  EXPECT_TRUE(senses(row.keys[0]));
  sensor.layer = 7;
  ASSERT_EQ(sensors.set(any, sensor), Status::ok);
  ASSERT_EQ(sensors.sense(), Status::ok);
  EXPECT_FALSE(senses(row.keys[0]));
  sensor.layer = 4096;
  EXPECT_EQ(sensors.set(any, sensor), Status::invalid_argument);
  expect_error(sensors.add(sensor), Status::invalid_argument);
}

TEST(SceneFilters, layers_out_of_range_are_refused) {
  Row row;
  EXPECT_EQ(row.scene.set_layer(row.keys[0], 4096), Status::invalid_argument);
  EXPECT_EQ(row.scene.set_layers_collide(4096, 0), Status::invalid_argument);
  EXPECT_EQ(row.scene.set_layers_collide(0, 65535, false), Status::invalid_argument);
  EXPECT_EQ(row.scene.set_layer(Key{}, 1), Status::invalid_key);
  BodyDefinition body = expect_ok(row.scene.body(row.keys[0]));
  body.layer = 5000;
  Key key;
  expect_error(row.scene.add(body), Status::invalid_argument);
  EXPECT_EQ(row.scene.layer(row.keys[0]), 0);
  // A layer can also exclude itself.
  ASSERT_EQ(row.scene.set_layers_collide(0, 0, false), Status::ok);
  EXPECT_TRUE(row.pairs().empty());
  row.scene.clear();
  body.layer = 9;
  key = expect_ok(row.scene.add(body));
  EXPECT_EQ(row.scene.layer(key), 9);
}

TEST(SceneFilters, refused_memory_changes_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  SceneWorld world(40, 32);
  Scene scene(world.pool, {.memory = &memory});
  ASSERT_EQ(add_all(scene, world), Status::ok);
  for (std::size_t granted = 0; granted < 2; ++granted) {
    memory.refuse_after(granted);
    EXPECT_EQ(scene.set_ignored(world.keys[0], world.keys[1]), Status::out_of_memory);
    memory.grant_all();
    EXPECT_FALSE(scene.is_ignored(world.keys[0], world.keys[1]));
    EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
  }
  ASSERT_EQ(scene.set_ignored(world.keys[0], world.keys[1]), Status::ok);
  EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
}

TEST(SceneFilters, move_by_positions_keeps_orientations) {
  ShapePool pool;
  ShapeId box = expect_ok(pool.add(BoxShape{{1, 2, 3}}));
  Scene scene(pool);
  Key keys[2];
  Pose turned = Pose::at(0, 0, 0);
  for (double& q : turned.orientation) q = 0.5;
  keys[0] = expect_ok(scene.add({.shape = box, .pose = turned}));
  keys[1] = expect_ok(scene.add({.shape = box}));
  const std::vector<Vec3d> places{{4, 5, 6}, {7, 8, 9}};
  const double x[2] = {1, 2};
  const double y[2] = {3, 4};
  const double z[2] = {5, 6};
  for (const PoseView& view : {PoseView::of_positions(places), PoseView({x, y, z}, 2)}) {
    ASSERT_EQ(scene.move(keys, view), Status::ok);
    BodyDefinition body = expect_ok(scene.body(keys[0]));
    for (const double q : body.pose.orientation) EXPECT_EQ(q, 0.5);
    EXPECT_EQ(body.pose.position[0], view[0].position[0]);
    EXPECT_EQ(body.pose.position[2], view[0].position[2]);
  }
}

}  // namespace
}  // namespace winnow::test
