// A scene and contacts that reserved memory allocate nothing more within the reserved sizes.

#include "tests/pipeline/scene_world.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

constexpr ContactLevel kLevels[] = {ContactLevel::pairs, ContactLevel::boolean,
                                    ContactLevel::distance, ContactLevel::manifold};

[[nodiscard]] Execution execution_of(bool parallel) {
  return parallel ? Execution::parallel() : Execution::serial();
}

/// Bodies without filters, for which `reserve` provides no memory.
[[nodiscard]] SceneWorld plain_world(std::size_t count, std::uint64_t seed) {
  SceneWorld world(count, seed);
  for (BodyDefinition& body : world.bodies) body.filter = {};
  return world;
}

/// Raises each size to the size in this frame.
void widen(SceneCapacity& room, const Scene& scene, const Contacts& contacts) {
  for (std::size_t i = 0; i < kBodyStates; ++i) {
    room.bodies[i] = std::max(room.bodies[i], scene.size(static_cast<BodyState>(i)));
  }
  room.pairs = std::max(room.pairs, static_cast<std::size_t>(scene.statistics().body_pairs));
  room.touching = std::max(room.touching, contacts.size());
  room.manifolds = std::max(room.manifolds, contacts.manifolds());
  room.points = std::max(room.points, contacts.points());
}

[[nodiscard]] SceneCapacity room_of_first_frame(SceneWorld& world, ContactLevel level) {
  SceneCapacity room{.level = level};
  Scene scene(world.pool);
  Contacts contacts;
  EXPECT_EQ(add_all(scene, world), Status::ok);
  EXPECT_EQ(scene.collide(level, contacts), Status::ok);
  widen(room, scene, contacts);
  return room;
}

TEST(SceneReserve, first_frame_allocates_nothing) {
  for (const ContactLevel level : kLevels) {
    for (const bool parallel : {false, true}) {
      for (const double cache_tolerance : {0.0, 0.01}) {
        SceneWorld world = plain_world(scaled(700), 41);
        const SceneCapacity room = room_of_first_frame(world, level);
        CountingMemory memory;
        CountingMemory results;
        Scene scene(world.pool, {.memory = &memory,
                                 .execution = execution_of(parallel),
                                 .cache_tolerance = cache_tolerance,
                                 .warm_start = true});
        SceneCapacity wide = room;
        // The cache tolerance enlarges boxes and thus the number of pairs.
        wide.pairs += room.pairs / 2;
        Contacts contacts(&results);
        ASSERT_EQ(scene.reserve(wide), Status::ok);
        ASSERT_EQ(scene.reserve_contacts(contacts, wide), Status::ok);
        EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
        EXPECT_EQ(contacts.footprint().total().reserved, results.outstanding());
        const std::size_t requests = memory.requests();
        const std::size_t result_requests = results.requests();
        ASSERT_EQ(add_all(scene, world), Status::ok);
        EXPECT_EQ(memory.requests(), requests) << "while adding bodies";
        ASSERT_EQ(scene.collide(level, contacts), Status::ok);
        EXPECT_EQ(memory.requests(), requests)
            << static_cast<int>(level) << parallel << cache_tolerance;
        EXPECT_EQ(results.requests(), result_requests)
            << static_cast<int>(level) << cache_tolerance;
        EXPECT_GT(contacts.size(), world.bodies.size() / 4);
        EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
        EXPECT_EQ(contacts.footprint().total().reserved, results.outstanding());
      }
    }
  }
}

/// Each frame moves all bodies, removes and adds some, and changes the state of some.
class Churn {
 public:
  Churn(Scene& scene, SceneWorld& world, std::uint64_t seed)
      : scene_(scene), world_(world), random_(seed) {}

  void frame() {
    world_.stir(0.05);
    for (int change = 0; change < 8; ++change) {
      const std::size_t i = random_.below(world_.bodies.size());
      if (world_.removed[i]) {
        world_.keys[i] = expect_ok(scene_.add(world_.bodies[i]));
        world_.removed[i] = false;
      } else if (random_.chance(0.5)) {
        EXPECT_EQ(scene_.remove(world_.keys[i]), Status::ok);
        world_.removed[i] = true;
      } else {
        world_.bodies[i].state = static_cast<BodyState>(random_.below(kBodyStates));
        EXPECT_EQ(scene_.set_body_state(world_.keys[i], world_.bodies[i].state), Status::ok);
      }
    }
    EXPECT_EQ(move_all(scene_, world_), Status::ok);
  }

 private:
  Scene& scene_;
  SceneWorld& world_;
  Random random_;
};

TEST(SceneReserve, reserved_contacts_never_allocate_while_bodies_change) {
  const std::size_t frames = scaled(300);
  for (const ContactLevel level : kLevels) {
    for (const bool parallel : {false, true}) {
      SceneCapacity room{.level = level};
      for (const bool measuring : {true, false}) {
        SceneWorld world = plain_world(300, 43);
        CountingMemory memory;
        Scene scene(world.pool,
                    {.memory = &memory, .execution = execution_of(parallel), .warm_start = true});
        CountingMemory results;
        Contacts contacts(&results);
        if (!measuring) {
          // The measured sizes leave out sleeping pairs. Reserve twice as much.
          room.touching *= 2;
          room.manifolds *= 2;
          room.points *= 2;
          ASSERT_EQ(scene.reserve(room), Status::ok);
          ASSERT_EQ(scene.reserve_contacts(contacts, room), Status::ok);
        }
        const std::size_t requests = results.requests();
        ASSERT_EQ(add_all(scene, world), Status::ok);
        Churn churn(scene, world, 47);
        for (std::size_t frame = 0; frame < frames; ++frame) {
          ASSERT_EQ(scene.collide(level, contacts), Status::ok);
          if (measuring) {
            widen(room, scene, contacts);
          } else {
            ASSERT_EQ(results.requests(), requests) << static_cast<int>(level) << parallel << frame;
          }
          churn.frame();
        }
        EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
        EXPECT_EQ(contacts.footprint().total().reserved, results.outstanding());
      }
    }
  }
}

TEST(SceneReserve, refused_memory_changes_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  SceneWorld world = plain_world(80, 53);
  SceneWorld reference_world = plain_world(80, 53);
  const SceneCapacity room{
      .bodies = {300, 300, 300}, .pairs = 900, .touching = 500, .manifolds = 500, .points = 1500};
  std::size_t refused = 0;
  for (const bool filled : {false, true}) {
    for (std::size_t granted = 0;; ++granted) {
      CountingMemory memory;
      CountingMemory results;
      Scene scene(world.pool, {.memory = &memory, .execution = Execution::serial()});
      Scene reference(reference_world.pool, {.execution = Execution::serial()});
      Contacts contacts(&results);
      Contacts truth;
      if (filled) {
        ASSERT_EQ(add_all(scene, world), Status::ok);
        ASSERT_EQ(add_all(reference, reference_world), Status::ok);
        ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
        ASSERT_EQ(reference.collide(ContactLevel::manifold, truth), Status::ok);
      }
      const auto before = digest(contacts);
      memory.refuse_after(granted);
      results.refuse_after(granted);
      const Status status = scene.reserve(room);
      const Status of_contacts = scene.reserve_contacts(contacts, room);
      memory.grant_all();
      results.grant_all();
      EXPECT_EQ(digest(contacts), before);
      EXPECT_EQ(scene.footprint().total().reserved, memory.outstanding());
      EXPECT_EQ(contacts.footprint().total().reserved, results.outstanding());
      const bool none = !filled && status != Status::ok;
      if (none) {
        EXPECT_EQ(scene.partition(BodyState::dynamic), nullptr);
      }
      if (!filled) {
        ASSERT_EQ(add_all(scene, world), Status::ok);
        ASSERT_EQ(add_all(reference, reference_world), Status::ok);
      }
      ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
      ASSERT_EQ(reference.collide(ContactLevel::manifold, truth), Status::ok);
      EXPECT_EQ(digest(contacts), digest(truth)) << granted;
      if (status == Status::ok && of_contacts == Status::ok) break;
      ++refused;
      EXPECT_TRUE(status == Status::ok || status == Status::out_of_memory);
    }
  }
  EXPECT_GT(refused, 50U);
}

TEST(SceneReserve, impossible_sizes_are_refused) {
  SceneWorld world(1, 59);
  CountingMemory memory;
  Scene scene(world.pool, {.memory = &memory});
  Contacts contacts(&memory);
  const std::size_t before = memory.requests();
  EXPECT_EQ(scene.reserve({.bodies = {1U << 27U, 1U << 27U, 0}}), Status::too_many_objects);
  EXPECT_EQ(scene.reserve({.pairs = ~std::size_t{0}}), Status::too_many_objects);
  EXPECT_EQ(scene.reserve({.level = static_cast<ContactLevel>(7)}), Status::invalid_argument);
  EXPECT_EQ(scene.reserve_contacts(contacts, {.points = ~std::size_t{0}}),
            Status::too_many_objects);
  EXPECT_EQ(memory.requests(), before);
  Scene wrong(world.pool, {.contact_margin = -1});
  EXPECT_EQ(wrong.reserve({}), Status::invalid_argument);
}

}  // namespace
}  // namespace winnow::test
