// Contacts of a scene, compared with tests of all pairs; events, states, filters, and order.

#include "tests/pipeline/scene_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/support/answers.h"
#include "tests/support/config.h"

namespace winnow::test {
namespace {

constexpr ContactLevel kLevels[] = {ContactLevel::boolean, ContactLevel::distance,
                                    ContactLevel::manifold};

[[nodiscard]] std::set<Names> keys_of(const std::map<Names, double>& pairs) {
  std::set<Names> names;
  for (const auto& [pair, distance] : pairs) names.insert(pair);
  return names;
}

TEST(Scene, five_bodies_make_three_pairs) {
  ShapePool pool;
  ShapeId box = expect_ok(pool.add(BoxShape{{1, 1, 1}}));
  const double places[5][2] = {{0, 0}, {4, 0}, {9, 5}, {1.8, 1.2}, {8, 6.5}};
  Scene scene(pool);
  Key key;
  for (ClientData i = 0; i < 5; ++i) {
    const BodyDefinition body{
        .shape = box, .pose = Pose::at(places[i][0], places[i][1], 0), .data = 'A' + i};
    key = expect_ok(scene.add(body));
  }
  ASSERT_EQ(scene.move(scene.key_of(1), Pose::at(3.5, 0, 0)), Status::ok);
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  EXPECT_EQ(shown(contacts), (std::set<Names>{{'A', 'D'}, {'B', 'D'}, {'C', 'E'}}));
}

TEST(Scene, pairs_without_dynamic_body_are_not_reported) {
  ShapePool pool;
  ShapeId ball = expect_ok(pool.add(SphereShape{1}));
  Scene scene(pool);
  Key keys[3];
  const BodyState states[] = {BodyState::fixed, BodyState::sleeping, BodyState::dynamic};
  for (ClientData i = 0; i < 3; ++i) {
    for (int copy = 0; copy < 2; ++copy) {
      keys[i] = expect_ok(scene.add({.shape = ball, .state = states[i], .data = i}));
    }
  }
  for (const ContactLevel level :
       {ContactLevel::pairs, ContactLevel::boolean, ContactLevel::manifold}) {
    Contacts contacts;
    ASSERT_EQ(scene.collide(level, contacts), Status::ok);
    EXPECT_EQ(contacts.size(), 9U);
    EXPECT_EQ(shown(contacts), (std::set<Names>{{0, 2}, {1, 2}, {2, 2}}));
  }
}

/// Compares events with sets of pairs while bodies move and leave.
TEST(Scene, events_match_sets_of_pairs) {
  for (const double cache_tolerance : {0.0, 1e-9}) {
    SceneWorld world(scaled(300), 3);
    for (BodyDefinition& body : world.bodies) body.state = BodyState::dynamic;
    Scene scene(world.pool, {.cache_tolerance = cache_tolerance});
    ASSERT_EQ(add_all(scene, world), Status::ok);
    Contacts contacts;
    std::set<Names> before;
    for (int frame = 0; frame < 12; ++frame) {
      ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
      std::set<Names> now = shown(contacts);
      std::set<Names> ended;
      for (const EndedContact& pair : contacts.ended()) {
        EXPECT_TRUE(ended.insert(names(pair.data_a, pair.data_b)).second);
      }
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        const bool persisted = contacts.event()[i] == ContactEvent::persisted;
        EXPECT_EQ(persisted, before.count(names(contacts.data_a()[i], contacts.data_b()[i])) == 1);
      }
      std::set<Names> gone;
      std::set_difference(before.begin(), before.end(), now.begin(), now.end(),
                          std::inserter(gone, gone.end()));
      EXPECT_EQ(ended, gone);
      before = std::move(now);
      world.stir(0.05);
      const std::size_t leaves = world.random.below(world.bodies.size());
      if (!world.removed[leaves]) {
        ASSERT_EQ(scene.remove(world.keys[leaves]), Status::ok);
        world.removed[leaves] = true;
      }
      ASSERT_EQ(move_all(scene, world), Status::ok);
    }
  }
}

TEST(Scene, sleeping_contacts_are_hidden_and_persist_on_waking) {
  for (const double cache_tolerance : {0.0, 0.01}) {
    ShapePool pool;
    ShapeId ball = expect_ok(pool.add(SphereShape{1}));
    Scene scene(pool, {.cache_tolerance = cache_tolerance});
    Key keys[4];
    for (ClientData i = 0; i < 4; ++i) {
      const double x = 1.9 * static_cast<double>(i);
      keys[i] = expect_ok(scene.add({.shape = ball, .pose = Pose::at(x, 0, 0), .data = i}));
    }
    Contacts contacts;
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    EXPECT_EQ(contacts.size(), 3U);
    ASSERT_EQ(scene.set_body_state(keys, BodyState::sleeping), Status::ok);
    for (int frame = 0; frame < 3; ++frame) {
      ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
      EXPECT_EQ(contacts.size(), 0U);
      EXPECT_TRUE(contacts.ended().empty());
    }
    ASSERT_EQ(scene.set_body_state(keys[1], BodyState::dynamic), Status::ok);
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    EXPECT_EQ(shown(contacts), (std::set<Names>{{0, 1}, {1, 2}}));
    for (const ContactEvent event : contacts.event()) EXPECT_EQ(event, ContactEvent::persisted);
    EXPECT_TRUE(contacts.ended().empty());
    ASSERT_EQ(scene.remove(keys[3]), Status::ok);
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    ASSERT_EQ(contacts.ended().size(), 1U);
    EXPECT_EQ(names(contacts.ended()[0].data_a, contacts.ended()[0].data_b), names(2, 3));
  }
}

TEST(Scene, contacts_persist_on_waking_after_other_levels) {
  for (const double cache_tolerance : {0.0, 0.01}) {
    ShapePool pool;
    const ShapeId ball = pool.add(SphereShape{1});
    Scene scene(pool, {.cache_tolerance = cache_tolerance});
    Key keys[12];
    for (ClientData i = 0; i < 12; ++i) {
      const double x = 1.9 * static_cast<double>(i);
      keys[i] = expect_ok(scene.add({.shape = ball, .pose = Pose::at(x, 0, 0), .data = i}));
    }
    Contacts contacts;
    for (const ContactLevel level :
         {ContactLevel::manifold, ContactLevel::boolean, ContactLevel::distance,
          ContactLevel::boolean, ContactLevel::manifold}) {
      for (int round = 0; round < 2; ++round) {
        ASSERT_EQ(scene.collide(level, contacts), Status::ok);
        EXPECT_EQ(contacts.size(), 11U);
        EXPECT_EQ(contacts.manifolds(), 11U);
      }
      ASSERT_EQ(scene.set_body_state(keys, BodyState::sleeping), Status::ok);
      ASSERT_EQ(scene.collide(level, contacts), Status::ok);
      EXPECT_EQ(contacts.size() + contacts.ended().size(), 0U);
      ASSERT_EQ(scene.set_body_state(keys, BodyState::dynamic), Status::ok);
      ASSERT_EQ(scene.collide(level, contacts), Status::ok);
      EXPECT_EQ(contacts.manifold_first()[11], 11U);
      for (const ContactEvent event : contacts.event()) EXPECT_EQ(event, ContactEvent::persisted);
    }
  }
}

TEST(Scene, contacts_match_on_any_threads_and_isa) {
  std::vector<std::uint64_t> first;
  const Isa isas[] = {available_isas().front(), available_isas().back()};
  for (const double cache_tolerance : {0.0, 0.02}) {
    first.clear();
    for (const Isa isa : isas) {
      const IsaScope scope(isa);
      for (const Workers& workers : all_workers()) {
        SceneWorld world(scaled(1500), 5);
        Threads arena(workers.threads);
        const std::vector<std::uint64_t> all = arena.run([&] {
          Scene scene(world.pool,
                      {.execution = workers.execution(), .cache_tolerance = cache_tolerance});
          EXPECT_EQ(add_all(scene, world), Status::ok);
          Contacts contacts;
          std::vector<std::uint64_t> bits;
          for (int frame = 0; frame < 5; ++frame) {
            EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
            const auto more = digest(contacts);
            bits.insert(bits.end(), more.begin(), more.end());
            world.stir(0.004);
            EXPECT_EQ(move_all(scene, world), Status::ok);
          }
          return bits;
        });
        if (first.empty()) first = all;
        EXPECT_TRUE(all == first) << isa_name() << ", " << to_string(workers);
      }
    }
  }
}

TEST(Scene, frames_without_cache_match_fresh_scene) {
  SceneWorld world(scaled(800), 7);
  Scene scene(world.pool);
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  for (int frame = 0; frame < 5; ++frame) {
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    Scene fresh(world.pool);
    std::vector<Key> keys(world.bodies.size());
    ASSERT_EQ(fresh.add(world.bodies, keys), Status::ok);
    Contacts fresh_contacts;
    ASSERT_EQ(fresh.collide(ContactLevel::manifold, fresh_contacts), Status::ok);
    ASSERT_EQ(contacts.points(), fresh_contacts.points());
    for (std::size_t m = 0; m < contacts.manifolds(); ++m) {
      ASSERT_EQ(contacts.distance()[m], fresh_contacts.distance()[m]);
      ASSERT_EQ(contacts.error_bound()[m], fresh_contacts.error_bound()[m]);
    }
    for (std::size_t p = 0; p < contacts.points(); ++p) {
      ASSERT_EQ(contacts.contact(p).feature, fresh_contacts.contact(p).feature);
      ASSERT_EQ(contacts.contact(p).depth, fresh_contacts.contact(p).depth);
    }
    EXPECT_EQ(shown(contacts), shown(fresh_contacts));
    world.stir(0.05);
    ASSERT_EQ(move_all(scene, world), Status::ok);
  }
}

TEST(Scene, touching_pairs_match_brute_force) {
  for (const double margin : {0.0, 0.15}) {
    SceneWorld world(scaled(400));
    Scene scene(world.pool, {.contact_margin = margin});
    ASSERT_EQ(add_all(scene, world), Status::ok);
    Contacts contacts;
    for (int frame = 0; frame < 4; ++frame) {
      for (const ContactLevel level : kLevels) {
        ASSERT_EQ(scene.collide(level, contacts), Status::ok);
        const double reach = level == ContactLevel::boolean ? 0.0 : margin;
        EXPECT_EQ(shown(contacts), keys_of(world.touching(reach)));
        EXPECT_EQ(shown(contacts).size(), contacts.size()) << "duplicate pair";
      }
      world.stir(0.2);
      ASSERT_EQ(move_all(scene, world), Status::ok);
    }
  }
}

TEST(Scene, distances_and_depths_match_brute_force) {
  SceneWorld world(scaled(400));
  Scene scene(world.pool, {.contact_margin = 0.1});
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  const auto truth = world.touching(0.1);
  ASSERT_EQ(contacts.size(), truth.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t m = contacts.manifold_first()[i];
    ASSERT_EQ(contacts.manifold_first()[i + 1], m + 1);
    const double distance = truth.at(names(contacts.data_a()[i], contacts.data_b()[i]));
    EXPECT_NEAR(contacts.distance()[m], distance, contacts.error_bound()[m] + 1e-9);
    EXPECT_EQ(contacts.part_a()[m], kWholeShape);
    EXPECT_GT(contacts.point_first()[m + 1], contacts.point_first()[m]);
    const auto deepest = [&] {
      float depth = -1e30F;
      for (auto p = contacts.point_first()[m]; p < contacts.point_first()[m + 1]; ++p) {
        depth = std::max(depth, contacts.contact(p).depth);
      }
      return static_cast<double>(depth);
    }();
    EXPECT_NEAR(deepest, -distance, contacts.error_bound()[m] + 1e-5);
  }
}

}  // namespace
}  // namespace winnow::test
