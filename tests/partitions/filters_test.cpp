// Object filters: exactly the pairs that pass the filters are reported, after any change of
// filters; without filters there is no cost.

#include <algorithm>
#include <array>
#include <atomic>

#include "tests/support/answers.h"
#include "tests/support/counting_memory.h"
#include "tests/support/hostile_scenes.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

ObjectFilter any_filter(Random& random) {
  if (random.chance(0.2)) return {};
  if (random.chance(0.1)) return {0, ~0U, 0};
  if (random.chance(0.1)) return {1, 0, 0};
  const auto layers = static_cast<std::uint32_t>(1 + random.below(15));
  const auto mask = static_cast<std::uint32_t>(random.below(16)) | 0x80000000U;
  const std::size_t environment = random.below(4);
  return {layers, mask,
          environment == 3 ? kAllEnvironments : static_cast<std::uint32_t>(environment)};
}

std::vector<ObjectFilter> any_filters(std::size_t count, Random& random) {
  std::vector<ObjectFilter> filters(count);
  for (ObjectFilter& filter : filters) filter = any_filter(random);
  return filters;
}

class Filters : public Conformance {
 protected:
  // Partitions that report false pairs report too many of them in large scenes.
  [[nodiscard]] std::size_t scene_size(std::size_t requested) const {
    return config().make().is_exact() ? requested : std::min<std::size_t>(requested, 120);
  }

  CountingMemory memory_;
};

TEST_P(Filters, pairs_pass_the_filters_in_any_scene) {
  for (const auto* scenes : {&degenerate_scenes(), &infinite_scenes(), &extreme_float_scenes()}) {
    for (const Scene& scene : *scenes) {
      SCOPED_TRACE(scene.name);
      World world(config());
      Random random(scene.boxes.size());
      const std::span<const Aabb> boxes(scene.boxes);
      const auto keys = world.insert(boxes.first(std::min(boxes.size(), scene_size(250))));
      world.set_filter(keys, any_filters(keys.size(), random));
      ASSERT_TRUE(world.agrees());
    }
  }
}

TEST_P(Filters, filters_hold_while_everything_changes) {
  World world(config(), &memory_);
  PairBuffer buffer;
  Random random(5);
  std::vector<Aabb> boxes = mixed_boxes(scene_size(400));
  std::vector<Key> keys = world.insert(boxes);
  for (std::size_t frame = 0; frame < 24; ++frame) {
    SCOPED_TRACE(frame);
    move(kMotions[frame % kMotions.size()], boxes, random);
    world.update(keys, boxes);
    const std::size_t first = random.below(keys.size());
    const std::size_t some = 1 + random.below(frame % 3 == 0 ? keys.size() - first : 8);
    const std::size_t count = std::min(some, keys.size() - first);
    world.set_filter(std::span(keys).subspan(first, count), any_filters(count, random));
    for (int i = 0; i < 10; ++i) {
      const std::size_t at = random.below(keys.size());
      world.remove(keys[at]);
      keys[at] = world.insert(boxes[at]);
    }
    ASSERT_TRUE(world.agrees(buffer, {.order = frame % 4 == 3 ? Order::canonical : Order::fast,
                                      .incremental = frame % 5 != 4}));
    ASSERT_TRUE(world.holds_its_objects());
    ASSERT_EQ(world.partition().footprint().total().reserved, memory_.outstanding());
  }
}

TEST_P(Filters, changed_filters_change_the_next_pairs) {
  World world(config());
  PairBuffer buffer;
  const std::vector<Key> keys = world.insert(uniform_boxes(scene_size(600)));
  ASSERT_TRUE(world.agrees(buffer));
  Random random(8);
  for (int frame = 0; frame < 6; ++frame) {
    for (int i = 0; i < 12; ++i) {
      world.set_filter(keys[random.below(keys.size())], any_filter(random));
    }
    ASSERT_TRUE(world.agrees(buffer));
  }
  EXPECT_GT(world.partition().statistics().incremental_queries, 0U);
  const std::vector<ObjectFilter> defaults(keys.size());
  world.set_filter(keys, defaults);
  EXPECT_TRUE(world.agrees(buffer));
}

TEST_P(Filters, pairs_with_applies_filters_of_both_partitions) {
  PairBuffer buffer;
  for (const bool mine_filtered : {false, true}) {
    for (const bool other_filtered : {false, true}) {
      for (const std::string_view name : structure_names()) {
        SCOPED_TRACE(name);
        World mine(config());
        World other({std::string(name), config().isa, config().threads});
        Random random(3);
        const auto my_keys = mine.insert(mixed_boxes(150));
        const auto other_keys = other.insert(mixed_boxes(90, 2));
        if (mine_filtered) mine.set_filter(my_keys, any_filters(my_keys.size(), random));
        if (other_filtered) other.set_filter(other_keys, any_filters(other_keys.size(), random));
        const bool exact = mine.partition().is_exact() && other.partition().is_exact();
        const auto can_pair = [](const World& a, const World& b, const Pair& pair) {
          return filters_allow(a.entries().at(pair.first).filter,
                               b.entries().at(pair.second).filter);
        };
        ASSERT_EQ(mine.pairs_with(other.partition(), buffer), Status::ok);
        EXPECT_TRUE(
            right_cross_pairs(buffer.pairs(), cross_pairs(mine.objects(), other.objects()), exact));
        EXPECT_TRUE(std::ranges::all_of(buffer.pairs(),
                                        [&](const Pair& p) { return can_pair(mine, other, p); }));
        ASSERT_EQ(other.pairs_with(mine.partition(), buffer), Status::ok);
        EXPECT_TRUE(
            right_cross_pairs(buffer.pairs(), cross_pairs(other.objects(), mine.objects()), exact));
        EXPECT_TRUE(std::ranges::all_of(buffer.pairs(),
                                        [&](const Pair& p) { return can_pair(other, mine, p); }));
      }
    }
  }
}

TEST_P(Filters, reused_id_does_not_keep_the_filter) {
  World world(config());
  const Aabb box{{0, 0, 0}, {1, 1, 1}};
  const Key first = world.insert(box);
  world.set_filter(first, {0, 0, 7});
  world.remove(first);
  const Key second = world.insert(box);
  ASSERT_EQ(second.id, first.id);
  EXPECT_TRUE(world.holds_its_objects());
  world.insert(box);
  EXPECT_TRUE(world.agrees());
  world.set_filter(second, {0, 0, 7});
  world.clear();
  world.insert(std::array{box, box, box});
  EXPECT_TRUE(world.holds_its_objects());
  EXPECT_TRUE(world.agrees());
}

TEST_P(Filters, set_filter_of_a_stale_key_is_refused) {
  World world(config());
  const std::vector<Key> keys = world.insert(uniform_boxes(20));
  const Key stale = world.insert(uniform_boxes(1)[0]);
  world.remove(stale);
  const ObjectFilter filter{3, 4, 5};
  EXPECT_EQ(world.partition().set_filter(stale, filter), Status::invalid_key);
  EXPECT_EQ(world.partition().set_filter(Key{}, filter), Status::invalid_key);
  expect_error(world.partition().filter(stale), Status::invalid_key);
  const std::array mixed{keys[0], stale, keys[1]};
  const std::vector<ObjectFilter> filters(3, filter);
  EXPECT_EQ(world.partition().set_filter(mixed, filters), Status::invalid_key);
  EXPECT_EQ(world.partition().set_filter(keys, filters), Status::size_mismatch);
  EXPECT_TRUE(world.holds_its_objects());
  EXPECT_TRUE(world.agrees());
}

TEST_P(Filters, default_filters_take_no_memory) {
  World world(config(), &memory_);
  const std::vector<Key> keys = world.insert(uniform_boxes(200));
  ASSERT_TRUE(world.agrees());
  const std::size_t requests = memory_.requests();
  world.set_filter(keys, std::vector<ObjectFilter>(keys.size()));
  EXPECT_EQ(memory_.requests(), requests);
  world.set_filter(keys[0], {1, 1, 0});
  EXPECT_GT(memory_.requests(), requests);
  EXPECT_EQ(world.partition().footprint().total().reserved, memory_.outstanding());
}

TEST_P(Filters, refused_memory_leaves_filters_unchanged) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  World world(config(), &memory_);
  const std::vector<Key> keys = world.insert(uniform_boxes(100));
  ASSERT_TRUE(world.agrees());
  Random random(2);
  const std::vector<ObjectFilter> filters = any_filters(keys.size(), random);
  memory_.refuse_after(0);
  EXPECT_EQ(world.partition().set_filter(keys, filters), Status::out_of_memory);
  memory_.grant_all();
  EXPECT_TRUE(world.holds_its_objects());
  EXPECT_TRUE(world.agrees());
  world.set_filter(keys, filters);
  // The tree cannot allocate the filter summaries of its nodes: the query returns an error and
  // succeeds later.
  memory_.refuse_after(0);
  PairBuffer buffer;
  const Status refused = world.self_pairs(buffer);
  memory_.grant_all();
  EXPECT_TRUE(refused == Status::out_of_memory || refused == Status::ok);
  EXPECT_TRUE(world.agrees(buffer));
  // Growth with filters in use fails as a whole or not at all.
  const std::vector<Aabb> more = uniform_boxes(3000);
  std::vector<Key> more_keys(more.size());
  for (std::size_t granted = 0;; ++granted) {
    memory_.refuse_after(granted);
    const Status status = world.partition().insert(more, {}, more_keys);
    memory_.grant_all();
    ASSERT_TRUE(world.partition().size() == (status == Status::ok ? 3100U : 100U));
    if (status == Status::ok) break;
    ASSERT_TRUE(world.holds_its_objects());
  }
}

TEST_P(Filters, empty_partition_releases_filter_memory) {
  World world(config(), &memory_);
  const std::vector<Key> keys = world.insert(uniform_boxes(500));
  world.set_filter(keys, std::vector<ObjectFilter>(keys.size(), ObjectFilter{2, 2, 1}));
  ASSERT_EQ(world.partition().refresh(), Status::ok);
  world.clear();
  world.partition().release_memory();
  EXPECT_EQ(world.partition().footprint().structure, config().make().footprint().structure);
  EXPECT_EQ(world.partition().footprint().total().reserved, memory_.outstanding());
}

TEST_P(Filters, steady_frames_do_not_allocate) {
  World world(config(), &memory_);
  CountingMemory results;
  PairBuffer buffer(&results);
  const std::vector<Aabb> boxes = uniform_boxes(scene_size(500));
  const std::vector<Key> keys = world.insert(boxes);
  Random random(4);
  std::array<std::vector<ObjectFilter>, 3> filters;
  for (auto& of_frame : filters) of_frame = any_filters(keys.size(), random);
  const auto play = [&](std::size_t frame) {
    world.set_filter(keys, filters[frame % 3]);
    world.update(keys, boxes);
    ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  };
  for (std::size_t frame = 0; frame < 9; ++frame) play(frame);
  const std::size_t requests = memory_.requests() + results.requests();
  for (std::size_t frame = 9; frame < 18; ++frame) play(frame);
  EXPECT_EQ(memory_.requests() + results.requests(), requests);
}

INSTANTIATE_TEST_SUITE_P(All, Filters, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

class FiltersOfVolumes : public Conformance {
 protected:
  /// A partition of volumes around boxes, some of which move from query to query.
  struct Volumes {
    Partition partition;
    std::vector<Key> keys;
    PairBuffer pairs;

    Volumes(const Config& config, Volume volume, std::span<const Aabb> boxes)
        : partition(make(config, volume)), keys(boxes.size()) {
      EXPECT_EQ(partition.insert(boxes, {}, keys), Status::ok);
    }
    static Partition make(const Config& config, Volume volume) {
      PartitionOptions options;
      options.volume = volume;
      options.execution = config.execution();
      return Partition(structure_named(config.partition), options);
    }
    void update_and_query(std::span<const Aabb> boxes) {
      ASSERT_EQ(partition.update(keys, boxes), Status::ok);
      PairOptions options;
      options.order = Order::canonical;
      ASSERT_EQ(partition.self_pairs(pairs, options), Status::ok);
    }
  };
};

TEST_P(FiltersOfVolumes, volumes_pair_only_if_filters_allow) {
  const Config all_with_all{"BoundsNSquared", config().isa, 1};
  for (const Volume volume : {Volume::sphere, Volume::kdop14, Volume::kdop18, Volume::kdop26}) {
    SCOPED_TRACE(static_cast<int>(volume));
    Random random(7);
    std::vector<Aabb> boxes = uniform_boxes(scaled(1200));
    Volumes plain(all_with_all, volume, boxes);
    Volumes filtered(config(), volume, boxes);
    const std::vector<ObjectFilter> filters = any_filters(boxes.size(), random);
    ASSERT_EQ(filtered.partition.set_filter(filtered.keys, filters), Status::ok);
    for (const Motion motion : {Motion::still, Motion::little, Motion::few, Motion::teleport}) {
      move(motion, boxes, random);
      ASSERT_NO_FATAL_FAILURE(plain.update_and_query(boxes));
      ASSERT_NO_FATAL_FAILURE(filtered.update_and_query(boxes));
      std::vector<Pair> expected;
      for (const Pair& pair : plain.pairs) {
        if (filters_allow(filters[pair.first], filters[pair.second])) expected.push_back(pair);
      }
      ASSERT_TRUE(std::ranges::equal(filtered.pairs, expected));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, FiltersOfVolumes, testing::ValuesIn(exact_configs()),
                         testing::PrintToStringParamName());

// Counts tests of 16 boxes: the count is equal on every instruction set and number of threads.
class FilterWork : public Conformance {};

TEST_P(FilterWork, nodes_without_accepted_objects_are_skipped) {
  World world(config());
  const std::vector<Key> keys = world.insert(uniform_boxes(4000));
  PairBuffer buffer;
  ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  const std::uint64_t all = world.partition().statistics().last_tests;
  // The filters accept only pairs that contain one of ten objects.
  std::vector<ObjectFilter> filters(keys.size(), ObjectFilter{2, 1, 0});
  for (std::size_t i = 0; i < 10; ++i) filters[i * 400] = {1, 3, 0};
  world.set_filter(keys, filters);
  ASSERT_TRUE(world.agrees(buffer, {.incremental = false}));
  EXPECT_LT(8 * world.partition().statistics().last_tests, all);
}

INSTANTIATE_TEST_SUITE_P(All, FilterWork,
                         testing::Values(Config{"LinearBvh", active_isa(), 1},
                                         Config{"BoundsNSquared", active_isa(), 1}),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
