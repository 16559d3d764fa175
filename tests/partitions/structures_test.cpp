// Structures as values: the list of structures, and the exchange of the structure of a partition
// that keeps its objects.

#include <winnow/partitions/partition.h>

#include <algorithm>
#include <atomic>
#include <set>

#include "tests/support/answers.h"
#include "tests/support/counting_memory.h"
#include "tests/support/motion.h"
#include "tests/support/platform.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

#if WINNOW_TEST_THREADS
#include <thread>
#endif

namespace winnow::test {
namespace {

TEST(Structures, structures_are_found_by_name) {
  std::set<std::string_view> names;
  for (const StructureKind kind : all_structures()) {
    EXPECT_TRUE(names.insert(kind.name()).second) << kind.name();
    EXPECT_EQ(structure_named(kind.name()), kind);
  }
  EXPECT_TRUE(names.contains(linear_bvh().name()));
  EXPECT_TRUE(names.contains(automatic().name()));
  EXPECT_EQ(structure_named("no such structure"), StructureKind{});
}

TEST(Structures, exchanged_structure_keeps_the_objects) {
  Partition partition(linear_bvh());
  const std::vector<Aabb> boxes{{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}};
  std::vector<Key> keys(2);
  ASSERT_EQ(partition.insert(boxes, {}, keys), Status::ok);

  ASSERT_EQ(partition.set_structure(flat_grid()), Status::ok);

  PairBuffer pairs;
  ASSERT_EQ(partition.self_pairs(pairs), Status::ok);
  EXPECT_EQ(pairs.size(), 1U);
  EXPECT_TRUE(partition.contains(keys[0]));
  EXPECT_EQ(partition.name(), "FlatGrid");
}

// The buffer of a structure without exact tests is not updated but filled again.
TEST(Structures, exchange_updates_the_exactness_of_pairs) {
  Partition partition(n_squared());
  const std::vector<Aabb> boxes = uniform_boxes(100);
  std::vector<Key> keys(boxes.size());
  ASSERT_EQ(partition.insert(boxes, {}, keys), Status::ok);
  const std::vector<Pair> truth = brute_force_pairs(numbered(boxes));
  PairBuffer pairs;
  PairEvents events;
  for (int round = 0; round < 2; ++round) {
    ASSERT_EQ(partition.set_structure(n_squared()), Status::ok);
    ASSERT_EQ(partition.self_pairs(pairs, events), Status::ok);
    EXPECT_EQ(pairs.size(), boxes.size() * (boxes.size() - 1) / 2);
    ASSERT_EQ(partition.set_structure(flat_grid()), Status::ok);
    ASSERT_EQ(partition.self_pairs(pairs, events), Status::ok);
    EXPECT_TRUE(partition.is_exact());
    EXPECT_TRUE(right_pairs(pairs.pairs(), truth, true));
    EXPECT_EQ(events.persisting(), truth.size());
  }
}

// Exchanges every structure for every other one, in a moving scene with filters, a tracked buffer
// and events.
TEST(Structures, exchange_keeps_keys_filters_pairs_and_events) {
  const Config config{"LinearBvh", active_isa(), 2};
  World world(config);
  World reference(config);
  std::vector<Aabb> boxes = mixed_boxes(400);
  const std::vector<Key> keys = world.insert(boxes);
  const std::vector<Key> reference_keys = reference.insert(boxes);
  world.set_filter(keys[7], {.environment = 3});
  reference.set_filter(reference_keys[7], {.environment = 3});
  PairBuffer pairs;
  PairBuffer reference_pairs;
  PairEvents events;
  PairEvents reference_events;
  Random random(23);
  const PairOptions canonical{.order = Order::canonical};
  for (const StructureKind from : all_structures()) {
    for (const StructureKind to : all_structures()) {
      if (from.name() == "NSquared" || to.name() == "NSquared") continue;
      for (const StructureKind kind : {from, to}) {
        ASSERT_EQ(world.partition().set_structure(kind), Status::ok);
        (void)move(Motion::few, boxes, random);
        world.update(keys, boxes);
        reference.update(reference_keys, boxes);
        ASSERT_EQ(world.partition().self_pairs(pairs, events, canonical), Status::ok);
        ASSERT_EQ(reference.partition().self_pairs(reference_pairs, reference_events, canonical),
                  Status::ok);
        ASSERT_EQ(pairs.size(), reference_pairs.size()) << from.name() << " to " << to.name();
        ASSERT_EQ(events.begun().size(), reference_events.begun().size());
        ASSERT_EQ(events.ended().size(), reference_events.ended().size());
        ASSERT_EQ(events.persisting(), reference_events.persisting());
        ASSERT_TRUE(world.holds_its_objects());
      }
    }
  }
}

TEST(Structures, choice_names_the_structure_in_use) {
  Partition partition(automatic());
  const std::vector<Aabb> boxes = uniform_boxes(3000);
  std::vector<Key> keys(boxes.size());
  ASSERT_EQ(partition.insert(boxes, {}, keys), Status::ok);
  ASSERT_EQ(partition.refresh(), Status::ok);
  EXPECT_EQ(partition.name(), "AutoPartition");
  const StructureChoice choice = partition.choice();
  EXPECT_NE(choice.structure.name(), "AutoPartition");
  EXPECT_EQ(choice.features.objects, boxes.size());
  EXPECT_FALSE(choice.reason.empty());
}

// Expects that a partition without state refuses every call with one status and changes nothing.
void expect_all_refused(Partition& partition, Status status) {
  const std::vector<Aabb> boxes(1);
  std::vector<Key> keys(1);
  PairBuffer pairs;
  PairEvents events;
  Hit hit;
  HitBuffer hits;
  OverlapBuffer objects;
  Aabb box;
  const Aabb point{{0, 0, 0}, {0, 0, 0}};
  EXPECT_EQ(partition.status(), status);
  EXPECT_EQ(partition.insert(boxes, {}, keys), status);
  EXPECT_EQ(partition.update(keys, boxes), status);
  EXPECT_EQ(partition.remove(keys), status);
  EXPECT_EQ(partition.reserve(10), status);
  EXPECT_EQ(partition.bounds(keys[0]).get(box), status);
  EXPECT_EQ(partition.set_filter(keys[0], ObjectFilter{}), status);
  EXPECT_EQ(partition.refresh(), status);
  EXPECT_EQ(partition.self_pairs(pairs), status);
  EXPECT_EQ(partition.self_pairs(pairs, events), status);
  EXPECT_EQ(partition.closest(Ray{{0, 0, 0}, {1, 0, 0}}).get(hit), status);
  EXPECT_EQ(partition.all(Ray{{0, 0, 0}, {1, 0, 0}}, hits), status);
  EXPECT_EQ(partition.overlap(Region(point), objects), status);
  EXPECT_EQ(partition.overlap(BoxView(boxes), pairs), status);
  EXPECT_EQ(partition.nearest(point, 1, 1.0F, hits), status);
  EXPECT_EQ(partition.size(), 0U);
  EXPECT_FALSE(partition.contains(keys[0]));
  EXPECT_EQ(partition.footprint().total().reserved, 0U);
  partition.clear();
  partition.release_memory();
}

TEST(Structures, objects_unsuitable_for_cells_use_the_tree) {
  constexpr std::size_t kObjects = 4000;
  const auto cells = [](StructureKind kind, const std::vector<Aabb>& boxes) {
    Partition partition(kind, {.execution = Execution::serial()});
    std::vector<Key> keys(boxes.size());
    EXPECT_EQ(partition.insert(boxes, {}, keys), Status::ok);
    EXPECT_EQ(partition.refresh(), Status::ok);
    return partition.statistics().cells;
  };
  constexpr std::size_t kBlocks = kObjects / 16;
  for (const StructureKind kind : {flat_grid(), sweep_and_prune()}) {
    EXPECT_EQ(cells(kind, mixed_boxes(kObjects)), kBlocks) << kind.name();
    EXPECT_NE(cells(kind, uniform_boxes(kObjects)), kBlocks) << kind.name();
  }
}

TEST(Structures, default_structure_kind_is_refused) {
  Partition partition{StructureKind{}};
  expect_all_refused(partition, Status::invalid_argument);
  Partition good(linear_bvh());
  EXPECT_EQ(good.set_structure(StructureKind{}), Status::invalid_argument);
  EXPECT_EQ(good.name(), "LinearBvh");
}

TEST(Structures, moved_from_partition_refuses_all_calls) {
  Partition from(sweep_and_prune());
  Key key = expect_ok(from.insert(Aabb{{0, 0, 0}, {1, 1, 1}}, 5));
  Partition to(std::move(from));
  EXPECT_TRUE(to.contains(key));
  expect_all_refused(from, Status::invalid_argument);  // NOLINT(bugprone-use-after-move)
  from = std::move(to);
  EXPECT_EQ(from.client_data_of(key.id), 5U);
}

TEST(Structures, refused_memory_is_reported) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  for (const StructureKind kind : all_structures()) {
    CountingMemory memory;
    std::size_t granted = 0;
    for (;; ++granted) {
      ASSERT_LT(granted, 10U);
      memory.refuse_after(granted);
      Partition partition(kind, {.memory = &memory});
      memory.grant_all();
      if (partition.status() == Status::ok) break;
      expect_all_refused(partition, Status::out_of_memory);
      EXPECT_EQ(memory.outstanding(), 0U);
    }
    EXPECT_GT(granted, 0U) << kind.name();
    Partition held(linear_bvh(), {.memory = &memory});
    memory.refuse_after(0);
    EXPECT_EQ(held.set_structure(kind), Status::out_of_memory) << kind.name();
    memory.grant_all();
    EXPECT_EQ(held.name(), "LinearBvh");
    EXPECT_EQ(held.footprint().total().reserved, memory.outstanding());
  }
}

#if WINNOW_TEST_THREADS
// A refresh reorders rows; a concurrent bounds() must return the box of its object.
TEST(Structures, bounds_during_a_refresh_are_right) {
  for (const StructureKind kind : {linear_bvh(), hierarchical_grid(), automatic()}) {
    Partition partition(kind);
    std::vector<Aabb> boxes = uniform_boxes(3000);
    std::vector<Key> keys(boxes.size());
    ASSERT_EQ(partition.insert(boxes, {}, keys), Status::ok);
    for (int round = 0; round < 8; ++round) {
      std::reverse(boxes.begin(), boxes.end());
      ASSERT_EQ(partition.update(keys, boxes), Status::ok);
      std::atomic<std::size_t> wrong{0};
      std::thread reader([&] {
        for (std::size_t i = 0; i < keys.size(); ++i) {
          Aabb box;
          if (partition.bounds(keys[i]).get(box) != Status::ok || box != boxes[i]) ++wrong;
        }
      });
      PairBuffer pairs;
      EXPECT_EQ(partition.self_pairs(pairs), Status::ok);
      reader.join();
      ASSERT_EQ(wrong, 0U) << kind.name();
    }
  }
}
#endif

}  // namespace
}  // namespace winnow::test
