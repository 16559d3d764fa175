// State of a scene between frames: cached contacts, memory, and the state after refused calls.

#include "tests/pipeline/scene_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Checks each contact against the current truth, within its error bound.
void expect_within_bounds(const Contacts& contacts, const SceneWorld& world,
                          double cache_tolerance) {
  const auto near = world.touching(cache_tolerance);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto truth = near.find(names(contacts.data_a()[i], contacts.data_b()[i]));
    ASSERT_NE(truth, near.end()) << "reported although farther apart than the bound";
    const std::uint32_t m = contacts.manifold_first()[i];
    EXPECT_LE(std::abs(contacts.distance()[m] - truth->second), contacts.error_bound()[m] + 1e-9);
  }
  const auto pairs = shown(contacts);
  for (const auto& [pair, distance] : near) {
    if (distance > 0.0) continue;
    EXPECT_EQ(pairs.count(pair), 1U) << "missed a touching pair";
  }
}

/// Returns the number of pairs in the last `collide` that bounding balls did not reject.
[[nodiscard]] std::uint64_t unrejected_pairs(const Scene& scene) {
  return scene.statistics().body_pairs - scene.statistics().rejected_by_spheres;
}

TEST(ContactCache, touching_pairs_are_reported_within_error_bounds) {
  for (const ContactLevel level : {ContactLevel::distance, ContactLevel::manifold}) {
    SceneWorld world(scaled(300), 11);
    const double cache_tolerance = 0.02;
    Scene scene(world.pool, {.cache_tolerance = cache_tolerance});
    ASSERT_EQ(add_all(scene, world), Status::ok);
    Contacts contacts;
    std::size_t cached_pairs = 0;
    for (int frame = 0; frame < 20; ++frame) {
      ASSERT_EQ(scene.collide(level, contacts), Status::ok);
      expect_within_bounds(contacts, world, cache_tolerance);
      cached_pairs += contacts.cached_pairs();
      world.stir(0.002);
      ASSERT_EQ(move_all(scene, world), Status::ok);
    }
    EXPECT_GT(cached_pairs, world.bodies.size());
  }
}

TEST(ContactCache, turning_pair_keeps_contact_that_turns_along) {
  ShapePool pool;
  ShapeId ball = expect_ok(pool.add(SphereShape{1}));
  Scene scene(pool, {.cache_tolerance = 0.01});
  Key keys[2];
  keys[0] = expect_ok(scene.add({.shape = ball}));
  keys[1] = expect_ok(scene.add({.shape = ball, .pose = Pose::at(1.9, 0, 0)}));
  Contacts contacts;
  for (int frame = 0; frame < 60; ++frame) {
    const double angle = 0.05 * frame;
    const double turn[4] = {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
    Pose poses[2];
    poses[1].position[0] = 1.9 * std::cos(angle);
    poses[1].position[1] = 1.9 * std::sin(angle);
    for (Pose& pose : poses) pose.orientation = turn;
    ASSERT_EQ(scene.move(keys, poses), Status::ok);
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    ASSERT_EQ(contacts.size(), 1U);
    EXPECT_EQ(contacts.cached_pairs(), frame == 0 ? 0U : 1U) << frame;
    EXPECT_NEAR(contacts.normal(0)[0], std::cos(angle), 0.011);
    EXPECT_NEAR(contacts.normal(1)[0], std::sin(angle), 0.011);
    EXPECT_NEAR(static_cast<double>(contacts.contact(0).position[1]), 0.95 * std::sin(angle),
                0.011);
  }
}

TEST(ContactCache, first_frame_after_teleport_is_exact) {
  SceneWorld world(scaled(300), 13);
  Scene scene(world.pool, {.cache_tolerance = 0.05});
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  for (BodyDefinition& body : world.bodies) body.pose = world.random_pose();
  ASSERT_EQ(move_all(scene, world), Status::ok);
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  const auto truth = world.touching();
  EXPECT_EQ(contacts.size(), truth.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t m = contacts.manifold_first()[i];
    EXPECT_LT(contacts.error_bound()[m], 1e-4);
  }
  for (const auto& [pair, distance] : truth) EXPECT_EQ(shown(contacts).count(pair), 1U);
}

TEST(ContactCache, resting_pairs_are_not_computed_again) {
  SceneWorld world(scaled(300), 17);
  Scene scene(world.pool, {.cache_tolerance = 0.001});
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  const auto first = digest(contacts);
  for (int frame = 0; frame < 3; ++frame) {
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    EXPECT_EQ(scene.statistics().convex.pairs, 0U);
    EXPECT_EQ(contacts.cached_pairs(), unrejected_pairs(scene));
    for (const ContactEvent event : contacts.event()) EXPECT_EQ(event, ContactEvent::persisted);
  }
  EXPECT_EQ(digest(contacts).size(), first.size());
}

TEST(ContactCache, move_to_same_pose_changes_no_bit) {
  SceneWorld world(scaled(300), 18);
  Scene scene(world.pool, {.cache_tolerance = 0.01});
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  const std::vector<double> bounds(contacts.error_bound().begin(), contacts.error_bound().end());
  ASSERT_EQ(move_all(scene, world), Status::ok);
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  EXPECT_EQ(contacts.cached_pairs(), unrejected_pairs(scene));
  ASSERT_EQ(contacts.manifolds(), bounds.size());
  for (std::size_t m = 0; m < bounds.size(); ++m) EXPECT_EQ(contacts.error_bound()[m], bounds[m]);
}

TEST(SceneBytes, steady_frame_allocates_nothing_and_footprint_is_exact) {
  for (const double cache_tolerance : {0.0, 0.01}) {
    CountingMemory memory;
    CountingMemory results;
    {
      SceneWorld world(scaled(600), 19);
      Scene scene(world.pool, {.memory = &memory, .cache_tolerance = cache_tolerance});
      Contacts contacts(&results);
      ASSERT_EQ(add_all(scene, world), Status::ok);
      // Repeats the same four frames.
      std::vector<std::vector<BodyDefinition>> frames;
      for (int frame = 0; frame < 4; ++frame) {
        frames.push_back(world.bodies);
        world.stir(0.02);
      }
      for (int frame = 0; frame < 24; ++frame) {
        world.bodies = frames[static_cast<std::size_t>(frame % 4)];
        ASSERT_EQ(move_all(scene, world), Status::ok);
        const std::size_t requests = memory.requests() + results.requests();
        ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
        if (frame >= 12) {
          EXPECT_EQ(memory.requests() + results.requests(), requests) << frame;
        }
        EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
        EXPECT_EQ(contacts.footprint().total().reserved, results.outstanding());
      }
      EXPECT_EQ(scene.footprint().mid_phase.reserved, 0U);
    }
    EXPECT_EQ(memory.outstanding(), 0U);
  }
}

// Without caching and warm start only the pairs of the last frame are stored.
TEST(SceneBytes, unused_data_of_last_frame_is_freed) {
  const auto remembered = [](const SceneOptions& options) {
    SceneWorld world(scaled(600), 19);
    Scene scene(world.pool, options);
    Contacts contacts;
    EXPECT_EQ(add_all(scene, world), Status::ok);
    for (int frame = 0; frame < 4; ++frame) {
      EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    }
    EXPECT_GT(contacts.points(), 0U);
    const Footprint bytes = contacts.footprint();
    return static_cast<double>(bytes.scratch.reserved) /
           static_cast<double>(bytes.results.reserved);
  };
  EXPECT_LT(remembered({}), 1.0);
  EXPECT_GT(remembered({.warm_start = true}), 1.0);
  EXPECT_GT(remembered({.cache_tolerance = 0.01}), 1.0);
}

// Bodies, partitions, pairs and results together. SceneBatches.contact_takes_few_bytes checks the
// bytes of the results.
TEST(SceneBytes, contact_takes_at_most_250_bytes) {
  constexpr std::size_t kBalls = 40000;
  constexpr double kSide = 22.0;
  ShapePool shapes;
  ShapeId ball = expect_ok(shapes.add(SphereShape{0.5}));
  Random random(5);
  std::vector<BodyDefinition> bodies(kBalls);
  for (BodyDefinition& body : bodies) {
    body.shape = ball;
    for (double& p : body.pose.position) p = random.uniform(0.0, kSide);
  }
  for (const ContactLevel level : {ContactLevel::distance, ContactLevel::manifold}) {
    Scene scene(shapes, {.execution = Execution::serial()});
    Contacts contacts;
    std::vector<Key> keys(kBalls);
    ASSERT_EQ(scene.add(bodies, keys), Status::ok);
    for (int frame = 0; frame < 3; ++frame) {
      ASSERT_EQ(scene.move(keys[0], bodies[0].pose), Status::ok);
      ASSERT_EQ(scene.collide(level, contacts), Status::ok);
    }
    const Bytes bytes = scene.footprint().total();
    const std::size_t reserved = bytes.reserved + contacts.footprint().total().reserved;
    EXPECT_LE(static_cast<double>(reserved) / static_cast<double>(contacts.size()), 250.0);
  }
}

TEST(SceneBytes, small_scene_takes_a_kilobyte_per_body) {
  constexpr std::size_t kBodies = 20;
  CountingMemory memory;
  ShapePool shapes(&memory);
  ShapeId box = expect_ok(shapes.add(BoxShape{.half = {0.5, 0.5, 0.5}}));
  Scene scene(shapes, {.memory = &memory});
  Contacts contacts(&memory);
  for (std::size_t i = 0; i < kBodies; ++i) {
    BodyDefinition body{.shape = box};
    body.pose.position[0] = 3.0 * static_cast<double>(i);
    expect_ok(scene.add(body));
  }
  for (int frame = 0; frame < 4; ++frame) {
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  }
  EXPECT_LE(memory.outstanding(), kBodies * 1024);
}

TEST(SceneBytes, refused_memory_changes_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  SceneWorld world(60, 23);
  Scene scene(world.pool, {.memory = &memory, .execution = Execution::serial()});
  Contacts contacts;
  for (std::size_t granted = 0;; ++granted) {
    memory.refuse_after(granted);
    const Status status = add_all(scene, world);
    memory.grant_all();
    if (status == Status::ok) break;
    ASSERT_EQ(status, Status::out_of_memory);
    ASSERT_EQ(scene.size(), 0U);
    for (const Key& key : world.keys) ASSERT_EQ(key, Key{});
  }
  ASSERT_EQ(scene.size(), world.bodies.size());
  for (std::size_t granted = 0;; ++granted) {
    memory.refuse_after(granted);
    const Status status = scene.collide(ContactLevel::manifold, contacts);
    memory.grant_all();
    if (status == Status::ok) break;
    ASSERT_EQ(status, Status::out_of_memory);
    ASSERT_EQ(contacts.size(), 0U);
  }
  EXPECT_EQ(contacts.size(), world.touching().size());
}

/// Two equal scenes. Calls of `scene` are refused memory and repeated, calls of `other` are not.
struct TwoScenes {
  CountingMemory memory;
  SceneWorld world{60, 23};
  SceneWorld other_world{60, 23};
  Scene scene{world.pool, {.memory = &memory, .execution = Execution::serial()}};
  Scene other{other_world.pool, {.execution = Execution::serial()}};

  /// Runs `call` on `scene` with memory for `granted` requests; the next request is refused, and
  /// also all later ones unless `once` is set. Repeats the call if it failed. Then runs `call` on
  /// `other`. Returns true if the first call failed.
  template <typename Call>
  bool was_refused(std::size_t granted, bool once, Call&& call) {
    if (once) {
      memory.refuse_one_after(granted);
    } else {
      memory.refuse_after(granted);
    }
    const Status status = call(scene, world);
    memory.grant_all();
    EXPECT_TRUE(status == Status::ok || status == Status::out_of_memory);
    if (status != Status::ok) {
      EXPECT_EQ(call(scene, world), Status::ok);
    }
    EXPECT_EQ(call(other, other_world), Status::ok);
    return status != Status::ok;
  }
  void compare() {
    Contacts contacts;
    Contacts truth;
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    ASSERT_EQ(other.collide(ContactLevel::manifold, truth), Status::ok);
    EXPECT_EQ(digest(contacts), digest(truth));
  }
};

TEST(SceneBytes, ids_after_refused_add_match_unrefused_scene) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  for (const bool once : {false, true}) {
    std::size_t refused = 0;
    for (std::size_t granted = 0; granted < 100; ++granted) {
      TwoScenes scenes;
      refused += scenes.was_refused(granted, once, add_all) ? 1 : 0;
      EXPECT_EQ(scenes.world.keys.size(), scenes.other_world.keys.size());
      for (std::size_t i = 0; i < scenes.world.keys.size(); ++i) {
        ASSERT_EQ(scenes.world.keys[i].id, scenes.other_world.keys[i].id) << granted;
      }
      scenes.compare();
    }
    EXPECT_GT(refused, 0U);
  }
}

TEST(SceneBytes, refused_set_body_state_changes_no_body) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  for (const BodyState to : {BodyState::fixed, BodyState::dynamic, BodyState::sleeping}) {
    std::size_t refused = 0;
    for (std::size_t granted = 0; granted < 60; ++granted) {
      TwoScenes scenes;
      ASSERT_EQ(add_all(scenes.scene, scenes.world), Status::ok);
      ASSERT_EQ(add_all(scenes.other, scenes.other_world), Status::ok);
      const auto change = [&](Scene& scene, SceneWorld& world) {
        const Status status = scene.set_body_state(world.keys, to);
        if (status == Status::ok) return status;
        for (std::size_t i = 0; i < world.bodies.size(); ++i) {
          BodyDefinition body = expect_ok(scene.body(world.keys[i]));
          EXPECT_EQ(body.state, world.bodies[i].state) << granted;
          EXPECT_EQ(body.filter, world.bodies[i].filter) << granted;
        }
        return status;
      };
      refused += scenes.was_refused(granted, false, change) ? 1 : 0;
      scenes.compare();
    }
    EXPECT_GT(refused, 0U);
  }
}

TEST(SceneBytes, scene_constructed_without_memory_returns_out_of_memory) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  SceneWorld world(3, 23);
  memory.refuse_after(0);
  Scene scene(world.pool, {.memory = &memory});
  memory.grant_all();
  Key key;
  expect_error(scene.add(world.bodies[0]), Status::out_of_memory);
  EXPECT_EQ(scene.remove(key), Status::out_of_memory);
  EXPECT_EQ(scene.move(key, Pose{}), Status::out_of_memory);
  EXPECT_EQ(scene.set_body_state(key, BodyState::fixed), Status::out_of_memory);
  EXPECT_EQ(scene.set_shape(key, world.bodies[0].shape), Status::out_of_memory);
  EXPECT_EQ(scene.set_filter(key, {}), Status::out_of_memory);
  EXPECT_EQ(scene.refresh(), Status::out_of_memory);
  expect_error(scene.body(key), Status::out_of_memory);
  Contacts contacts;
  EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::out_of_memory);
  scene.clear();
  EXPECT_EQ(scene.size(), 0U);
  EXPECT_EQ(scene.size(BodyState::dynamic), 0U);
  EXPECT_FALSE(scene.contains(key));
  EXPECT_EQ(scene.key_of(0), Key{});
  EXPECT_EQ(scene.partition(BodyState::dynamic), nullptr);
  EXPECT_EQ(scene.statistics().body_pairs, 0U);
  EXPECT_EQ(scene.footprint().total().reserved, 0U);
  SceneQueries queries(scene);
  expect_error(queries.distance(key, key), Status::out_of_memory);
}

TEST(SceneBytes, contacts_constructed_without_memory_return_out_of_memory) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  SceneWorld world(20, 23);
  Scene scene(world.pool);
  ASSERT_EQ(add_all(scene, world), Status::ok);
  memory.refuse_after(0);
  Contacts contacts(&memory);
  memory.grant_all();
  EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::out_of_memory);
  contacts.clear();
  EXPECT_EQ(contacts.size(), 0U);
  EXPECT_EQ(contacts.manifolds(), 0U);
  EXPECT_EQ(contacts.points(), 0U);
  EXPECT_TRUE(contacts.runs().empty());
  EXPECT_EQ(contacts.footprint().total().reserved, 0U);
}

TEST(SceneInput, bad_input_is_refused_and_changes_nothing) {
  SceneWorld world(40, 29);
  Scene scene(world.pool);
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  const std::size_t pairs = contacts.size();
  Key key;
  BodyDefinition bad = world.bodies[0];
  bad.shape = {};
  expect_error(scene.add(bad), Status::invalid_key);
  bad.shape = ShapeId::of(CompositeKind::mesh, 0);
  expect_error(scene.add(bad), Status::unsupported);
  bad = world.bodies[0];
  bad.pose.position[1] = kNaN;
  expect_error(scene.add(bad), Status::invalid_pose);
  EXPECT_EQ(scene.move(world.keys[0], bad.pose), Status::invalid_pose);
  EXPECT_EQ(scene.move(Key{}, world.bodies[0].pose), Status::invalid_key);
  const Key twice[] = {world.keys[3], world.keys[3]};
  EXPECT_EQ(scene.remove(twice), Status::invalid_key);
  EXPECT_EQ(scene.set_body_state(twice, BodyState::fixed), Status::invalid_key);
  EXPECT_EQ(scene.set_body_state(world.keys[3], static_cast<BodyState>(9)),
            Status::invalid_argument);
  EXPECT_EQ(scene.set_shape(world.keys[0], {}), Status::invalid_key);
  EXPECT_EQ(scene.collide(static_cast<ContactLevel>(7), contacts), Status::invalid_argument);
  const Pose poses[] = {world.bodies[0].pose, bad.pose};
  EXPECT_EQ(scene.move(std::span(world.keys).first(2), poses), Status::invalid_pose);
  EXPECT_EQ(scene.move(std::span(world.keys).first(1), poses), Status::size_mismatch);
  Contacts after;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, after), Status::ok);
  EXPECT_EQ(after.size(), pairs);
  Scene wrong(world.pool, {.contact_margin = -1});
  expect_error(wrong.add(world.bodies[0]), Status::invalid_argument);
  Scene unknown(world.pool, {.structures = {linear_bvh(), StructureKind{}, linear_bvh()}});
  expect_error(unknown.add(world.bodies[0]), Status::invalid_argument);
}

TEST(SceneInput, random_changes_keep_pairs_right) {
  for (const std::string_view partition : {"LinearBvh", "FlatGrid", "SweepAndPrune"}) {
    SceneWorld world(scaled(250), 31);
    const StructureKind structure = structure_named(partition);
    Scene scene(world.pool, {.structures = {structure, structure, structure}});
    ASSERT_EQ(add_all(scene, world), Status::ok);
    Contacts contacts;
    Random random(37);
    for (int round = 0; round < 12; ++round) {
      for (int change = 0; change < 60; ++change) {
        const std::size_t i = random.below(world.bodies.size());
        BodyDefinition& body = world.bodies[i];
        if (world.removed[i]) {
          world.keys[i] = expect_ok(scene.add(body));
          world.removed[i] = false;
        } else if (random.chance(0.2)) {
          ASSERT_EQ(scene.remove(world.keys[i]), Status::ok);
          EXPECT_EQ(scene.remove(world.keys[i]), Status::invalid_key);
          world.removed[i] = true;
        } else if (random.chance(0.3)) {
          body.state = static_cast<BodyState>(random.below(3));
          ASSERT_EQ(scene.set_body_state(world.keys[i], body.state), Status::ok);
        } else if (random.chance(0.3)) {
          body.shape = world.shapes[random.below(world.shapes.size())];
          ASSERT_EQ(scene.set_shape(world.keys[i], body.shape), Status::ok);
        } else if (random.chance(0.2)) {
          body.filter.layers = static_cast<std::uint32_t>(1 + random.below(3));
          body.filter.mask = static_cast<std::uint32_t>(1 + random.below(3));
          ASSERT_EQ(scene.set_filter(world.keys[i], body.filter), Status::ok);
        } else {
          body.pose = world.random_pose();
          ASSERT_EQ(scene.move(world.keys[i], body.pose), Status::ok);
        }
      }
      ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
      EXPECT_EQ(contacts.size(), world.touching().size());
      for (const auto& [pair, distance] : world.touching()) {
        EXPECT_EQ(shown(contacts).count(pair), 1U) << partition << ": " << distance;
      }
    }
  }
}

}  // namespace
}  // namespace winnow::test
