// Islands compared with labels that are propagated to a fixed point, and colours checked for bodies
// that two pairs of a colour share.

#include "tests/pipeline/scene_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

[[nodiscard]] bool is_movable(const Scene& scene, Key key) {
  BodyDefinition body = expect_ok(scene.body(key));
  return body.state != BodyState::fixed;
}

/// Returns the ids of the bodies of a pair that are not fixed.
[[nodiscard]] std::vector<std::uint32_t> movable(const Scene& scene, const Contacts& contacts,
                                                 std::size_t pair) {
  std::vector<std::uint32_t> ids;
  for (const Key key : {contacts.a()[pair], contacts.b()[pair]}) {
    if (is_movable(scene, key)) ids.push_back(key.id);
  }
  return ids;
}

/// Checks that each pair is listed exactly once, in its group, and that lists ascend.
void expect_in_order(const ContactGroups& groups, std::size_t pairs) {
  ASSERT_EQ(groups.group().size(), pairs);
  std::size_t listed = 0;
  for (std::size_t group = 0; group < groups.size(); ++group) {
    EXPECT_FALSE(groups.pairs(group).empty());
    EXPECT_TRUE(std::is_sorted(groups.pairs(group).begin(), groups.pairs(group).end()));
    for (const std::uint32_t pair : groups.pairs(group)) {
      EXPECT_EQ(groups.group()[pair], group);
      ++listed;
    }
  }
  EXPECT_EQ(listed, pairs);
}

/// A row of balls on a floor: 0 1 2 touch, 3 is separate, 4 5 touch.
TEST(ContactGroups, bodies_sharing_only_a_floor_are_separate_islands) {
  ShapePool pool;
  ShapeId ball;
  ShapeId floor;
  ball = expect_ok(pool.add(SphereShape{1.0}));
  floor = expect_ok(pool.add(HalfSpaceShape{}));
  Scene scene(pool);
  Key key;
  ClientData name = 0;
  for (const double x : {0.0, 1.9, 3.8, 10.0, 20.0, 21.9}) {
    key = expect_ok(scene.add({.shape = ball, .pose = Pose::at(x, 0, 0.9), .data = name++}));
  }
  key = expect_ok(scene.add({.shape = floor, .state = BodyState::fixed, .data = name}));
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  ASSERT_EQ(contacts.size(), 9U);
  ContactGroups islands;
  ASSERT_EQ(scene.islands(contacts, islands), Status::ok);
  expect_in_order(islands, contacts.size());
  std::set<std::set<ClientData>> bodies;
  for (std::size_t island = 0; island < islands.size(); ++island) {
    std::set<ClientData> members;
    for (const std::uint32_t pair : islands.pairs(island)) {
      members.insert({contacts.data_a()[pair], contacts.data_b()[pair]});
    }
    bodies.insert(members);
  }
  EXPECT_EQ(bodies, (std::set<std::set<ClientData>>{{0, 1, 2, 6}, {3, 6}, {4, 5, 6}}));

  ContactGroups colours;
  ASSERT_EQ(scene.colours(contacts, colours), Status::ok);
  expect_in_order(colours, contacts.size());
  EXPECT_LE(colours.size(), 4U);
}

TEST(ContactGroups, no_contacts_make_no_groups) {
  ShapePool pool;
  Scene scene(pool);
  Contacts contacts;
  ContactGroups groups;
  for (int frame = 0; frame < 2; ++frame) {
    ASSERT_EQ(scene.islands(contacts, groups), Status::ok);
    expect_in_order(groups, 0);
    ASSERT_EQ(scene.colours(contacts, groups), Status::ok);
    expect_in_order(groups, 0);
    expect_ok(scene.add({.shape = pool.add(SphereShape{1.0})}));
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  }
}

TEST(ContactGroups, islands_are_connected_components) {
  SceneWorld world(scaled(600), 21);
  Scene scene(world.pool);
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  ContactGroups islands;
  for (int frame = 0; frame < 4; ++frame) {
    ASSERT_EQ(scene.collide(ContactLevel::boolean, contacts), Status::ok);
    ASSERT_EQ(scene.islands(contacts, islands), Status::ok);
    expect_in_order(islands, contacts.size());
    std::vector<std::uint32_t> label(world.bodies.size());
    for (std::uint32_t i = 0; i < label.size(); ++i) label[i] = i;
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        const auto ids = movable(scene, contacts, i);
        const std::uint32_t least = std::min(label[ids.front()], label[ids.back()]);
        for (const std::uint32_t id : ids) {
          changed = changed || label[id] != least;
          label[id] = least;
        }
      }
    }
    std::vector<std::uint32_t> seen;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const std::uint32_t of = label[movable(scene, contacts, i).front()];
      const auto at = std::find(seen.begin(), seen.end(), of);
      EXPECT_EQ(islands.group()[i], static_cast<std::uint32_t>(at - seen.begin()));
      if (at == seen.end()) seen.push_back(of);
    }
    EXPECT_EQ(islands.size(), seen.size());
    world.stir(0.1);
    ASSERT_EQ(move_all(scene, world), Status::ok);
  }
}

TEST(ContactGroups, pairs_of_a_colour_share_no_movable_body) {
  SceneWorld world(scaled(600), 22);
  Scene scene(world.pool);
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  ContactGroups colours;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  ASSERT_EQ(scene.colours(contacts, colours), Status::ok);
  expect_in_order(colours, contacts.size());
  std::map<std::uint32_t, std::size_t> degree;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    for (const std::uint32_t id : movable(scene, contacts, i)) ++degree[id];
  }
  std::size_t largest = 0;
  for (const auto& [id, count] : degree) largest = std::max(largest, count);
  EXPECT_LT(colours.size(), 2 * largest);
  for (std::size_t colour = 0; colour < colours.size(); ++colour) {
    std::set<std::uint32_t> used;
    for (const std::uint32_t pair : colours.pairs(colour)) {
      for (const std::uint32_t id : movable(scene, contacts, pair)) {
        EXPECT_TRUE(used.insert(id).second);
      }
    }
  }
}

TEST(ContactGroups, body_with_many_contacts_fills_rest_colour) {
  ShapePool pool;
  ShapeId large;
  ShapeId small;
  large = expect_ok(pool.add(SphereShape{10.0}));
  small = expect_ok(pool.add(SphereShape{0.1}));
  Scene scene(pool);
  Key key = expect_ok(scene.add({.shape = large}));
  constexpr int kSmall = 100;
  for (int i = 0; i < kSmall; ++i) {
    const double turn = 2.0 * 3.14159265358979 * i / kSmall;
    const Pose at = Pose::at(10.0 * std::cos(turn), 10.0 * std::sin(turn), 0.0);
    key = expect_ok(scene.add({.shape = small, .pose = at}));
  }
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::boolean, contacts), Status::ok);
  ASSERT_EQ(contacts.size(), std::size_t{kSmall});
  ContactGroups colours;
  ASSERT_EQ(scene.colours(contacts, colours), Status::ok);
  ASSERT_EQ(colours.size(), std::size_t{kContactColours});
  for (std::size_t colour = 0; colour < kRestColour; ++colour) {
    EXPECT_EQ(colours.pairs(colour).size(), 1U);
  }
  EXPECT_EQ(colours.pairs(kRestColour).size(), kSmall - std::size_t{kRestColour});
}

TEST(ContactGroups, groups_match_on_any_thread_count) {
  std::vector<std::uint32_t> first;
  for (const Workers& workers : all_workers()) {
    SceneWorld world(scaled(20'000), 23);
    Threads arena(workers.threads);
    const auto groups = arena.run([&] {
      Scene scene(world.pool, {.execution = workers.execution()});
      EXPECT_EQ(add_all(scene, world), Status::ok);
      Contacts contacts;
      ContactGroups out;
      EXPECT_EQ(scene.collide(ContactLevel::boolean, contacts), Status::ok);
      EXPECT_EQ(scene.islands(contacts, out), Status::ok);
      std::vector<std::uint32_t> all(out.group().begin(), out.group().end());
      EXPECT_EQ(scene.colours(contacts, out), Status::ok);
      all.insert(all.end(), out.group().begin(), out.group().end());
      return all;
    });
    if (first.empty()) first = groups;
    EXPECT_TRUE(groups == first) << to_string(workers);
  }
}

TEST(ContactGroups, removed_bodies_and_missing_memory_are_refused) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  SceneWorld world(50, 24);
  for (BodyDefinition& body : world.bodies) body.state = BodyState::dynamic;
  Scene scene(world.pool);
  ASSERT_EQ(add_all(scene, world), Status::ok);
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::boolean, contacts), Status::ok);
  ASSERT_NE(contacts.size(), 0U);
  ContactGroups groups(&memory);
  for (std::size_t granted = 0; granted < 4; ++granted) {
    ContactGroups fresh(&memory);
    memory.refuse_after(granted);
    EXPECT_EQ(scene.islands(contacts, fresh), Status::out_of_memory);
    EXPECT_EQ(scene.colours(contacts, fresh), Status::out_of_memory);
    EXPECT_EQ(fresh.size(), 0U);
    memory.grant_all();
  }
  ASSERT_EQ(scene.islands(contacts, groups), Status::ok);
  EXPECT_EQ(groups.footprint().total().reserved, memory.outstanding());
  ASSERT_EQ(scene.remove(contacts.a()[0]), Status::ok);
  EXPECT_EQ(scene.islands(contacts, groups), Status::invalid_key);
  EXPECT_EQ(scene.colours(contacts, groups), Status::invalid_key);
}

}  // namespace
}  // namespace winnow::test
