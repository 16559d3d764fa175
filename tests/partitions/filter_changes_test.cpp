// Summaries of object filters (in tree nodes and for the whole partition) follow the filters: after
// any change of filters, rows and ids, pair, box and ray queries equal a test of each object.

#include <algorithm>
#include <array>
#include <utility>

#include "tests/support/answers.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

constexpr std::uint32_t kOther = 2;  // a layer that no object is in by default

/// Returns query filters: one that accepts all objects, one of a single layer, one of another
/// environment, and one that accepts none.
std::vector<Filter> askers() {
  const auto with = [](std::uint32_t layers, std::uint32_t mask, std::uint32_t environment) {
    Filter filter;
    filter.layers = layers;
    filter.mask = mask;
    filter.environment = environment;
    return filter;
  };
  return {Filter{},
          with(1, 1, 0),
          with(kOther, ~0U, 0),
          with(~0U, kOther, kAllEnvironments),
          with(~0U, ~kOther, 0),
          with(1, ~0U, 5),
          with(0, ~0U, kAllEnvironments),
          with(~0U, 0, kAllEnvironments)};
}

class FilterChanges : public Conformance {
 protected:
  FilterChanges() : world_(config()) {}

  /// Compares pairs of all kinds and the results of boxes and rays with a test of every object.
  void expect_right_answers() {
    ASSERT_TRUE(world_.agrees(pairs_));
    ASSERT_TRUE(world_.agrees(buffer_, {.incremental = false}));
    for (const Filter& filter : askers()) {
      expect_right_boxes(filter);
      expect_right_rays(filter);
    }
  }

  World world_;
  Random random_{3};

 private:
  void expect_right_boxes(const Filter& filter) {
    const std::vector<Aabb> boxes = uniform_boxes(6, 77);
    ASSERT_EQ(world_.partition().overlap(BoxView(boxes), buffer_, filter, Order::canonical),
              Status::ok);
    std::vector<std::pair<std::uint32_t, ObjectId>> expected;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      for (const auto& [id, entry] : world_.entries()) {
        if (!boxes[i].overlaps(entry.box) || !filters_allow(filter.object(), entry.filter))
          continue;
        expected.emplace_back(i, id);
      }
    }
    std::vector<std::pair<std::uint32_t, ObjectId>> found;
    for (const Pair& pair : buffer_) found.emplace_back(pair.first, pair.second);
    ASSERT_EQ(found, expected);
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      OverlapBuffer objects;
      ASSERT_EQ(world_.partition().overlap(Region(boxes[i]), objects, filter), Status::ok);
      const auto of_box = [&](const auto& pair) { return pair.first == i; };
      ASSERT_EQ(objects.size(), static_cast<std::size_t>(std::ranges::count_if(expected, of_box)));
    }
  }

  // Casts rays through object centres: the closest hit is the nearest of all accepted hits.
  void expect_right_rays(const Filter& filter) {
    HitBuffer unfiltered;
    HitBuffer hits;
    for (int i = 0; i < 3 && !world_.entries().empty(); ++i) {
      Ray ray;
      ray.origin = {-50.0F, -40.0F, -60.0F};
      const auto at = static_cast<std::ptrdiff_t>(random_.below(world_.entries().size()));
      const Aabb& box = std::next(world_.entries().begin(), at)->second.box;
      ray.direction = 0.5F * (box.min + box.max) - ray.origin;
      std::vector<ObjectId> expected;
      for (const auto& [id, entry] : world_.entries()) {
        Partition single(bounds_n_squared(), {.execution = Execution::serial()});
        Key key;
        Hit hit;
        if (!filters_allow(filter.object(), entry.filter)) continue;
        key = expect_ok(single.insert(entry.box, 0));
        hit = expect_ok(single.closest(Cast(ray)));
        if (hit) expected.push_back(id);
      }
      ASSERT_EQ(world_.partition().all(Cast(ray), hits, filter), Status::ok);
      std::vector<ObjectId> found;
      for (const Hit& hit : hits.hits()) found.push_back(hit.key.id);
      std::ranges::sort(found);
      ASSERT_EQ(found, expected);
      Hit closest = expect_ok(world_.partition().closest(Cast(ray), filter));
      ASSERT_EQ(closest, hits.hits().empty() ? Hit{} : hits.hits().front());
    }
  }

  PairBuffer pairs_;
  PairBuffer buffer_;
};

TEST_P(FilterChanges, filter_change_shows_in_every_query) {
  const std::vector<Key> keys = world_.insert(uniform_boxes(scaled(400)));
  expect_right_answers();
  constexpr std::array<ObjectFilter, 5> kTurns{ObjectFilter{kOther, ~0U, 0}, ObjectFilter{},
                                               ObjectFilter{kOther, kOther, 0},
                                               ObjectFilter{1, ~kOther, 0}, ObjectFilter{1, 1, 0}};
  for (const ObjectFilter& filter : kTurns) {
    // One object, then a third of them, then all.
    for (const std::size_t count : {std::size_t{1}, keys.size() / 3, keys.size()}) {
      world_.set_filter(std::span(keys).first(count), std::vector<ObjectFilter>(count, filter));
      expect_right_answers();
    }
  }
}

TEST_P(FilterChanges, filters_survive_changes_of_rows) {
  std::vector<Aabb> boxes = uniform_boxes(scaled(500));
  std::vector<Key> keys = world_.insert(boxes);
  for (std::size_t i = 0; i < keys.size(); i += 3) {
    world_.set_filter(
        keys[i], i % 2 == 0 ? ObjectFilter{kOther, ~kOther, 0} : ObjectFilter{kOther, kOther, 0});
  }
  for (int frame = 0; frame < 12; ++frame) {
    SCOPED_TRACE(frame);
    move(kMotions[static_cast<std::size_t>(frame) % kMotions.size()], boxes, random_);
    world_.update(keys, boxes);
    // Some objects move far away, to the tail, and some new objects get ids of removed ones.
    for (int i = 0; i < 5; ++i) {
      const std::size_t at = random_.below(keys.size());
      world_.remove(keys[at]);
      keys[at] = world_.insert(boxes[random_.below(boxes.size())]);
      boxes[at] = world_.entries().at(keys[at].id).box;
      if (i % 2 == 0) world_.set_filter(keys[at], {kOther, 1, 0});
    }
    ASSERT_NO_FATAL_FAILURE(expect_right_answers());
  }
}

TEST_P(FilterChanges, removed_objects_narrow_the_node_summaries) {
  const std::vector<Aabb> boxes = uniform_boxes(scaled(300));
  std::vector<Key> keys = world_.insert(boxes);
  std::vector<Key> others;
  for (std::size_t i = 0; i < keys.size(); i += 2) others.push_back(keys[i]);
  world_.set_filter(others, std::vector<ObjectFilter>(others.size(), {kOther, ~0U, 0}));
  expect_right_answers();
  // Removes half of the other layer, then the rest; new objects get their ids.
  world_.remove(std::span(others).first(others.size() / 2));
  expect_right_answers();
  world_.remove(std::span(others).subspan(others.size() / 2));
  expect_right_answers();
  world_.insert(std::span(boxes).first(others.size()));
  expect_right_answers();
  EXPECT_TRUE(world_.holds_its_objects());
}

TEST_P(FilterChanges, environments_set_after_layers_count) {
  std::vector<Aabb> boxes = uniform_boxes(scaled(300));
  const std::vector<Key> keys = world_.insert(boxes);
  for (std::size_t i = 0; i < keys.size(); i += 4) world_.set_filter(keys[i], {kOther, ~0U, 0});
  expect_right_answers();
  for (const std::uint32_t environment : {5U, kAllEnvironments, 7U, 0U}) {
    for (std::size_t i = 0; i < keys.size(); i += 3) {
      world_.set_filter(keys[i], {1, ~0U, environment});
      if (i == 3) expect_right_answers();
    }
    expect_right_answers();
    move(Motion::much, boxes, random_);
    world_.update(keys, boxes);
    expect_right_answers();
  }
}

TEST_P(FilterChanges, every_environment_pairs_across_partitions) {
  const std::vector<Key> keys = world_.insert(uniform_boxes(scaled(200)));
  world_.set_filter(keys[0], {1, ~0U, kAllEnvironments});
  World other(config());
  const std::vector<Key> other_keys = other.insert(uniform_boxes(scaled(200), 2));
  other.set_filter(other_keys, std::vector<ObjectFilter>(other_keys.size(), {1, ~0U, 5}));
  expect_right_answers();
  const Aabb everywhere{{-100, -100, -100}, {100, 100, 100}};
  Filter filter;
  filter.environment = 5;
  PairBuffer found;
  ASSERT_EQ(world_.partition().overlap(BoxView(std::span(&everywhere, 1)), found, filter),
            Status::ok);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].second, keys[0].id);
  for (const auto& [a, b] : {std::pair{&world_, &other}, std::pair{&other, &world_}}) {
    ASSERT_EQ(a->pairs_with(b->partition(), found), Status::ok);
    std::size_t expected = 0;
    for (const auto& [id, entry] : other.entries()) {
      expected += entry.box.overlaps(world_.entries().at(keys[0].id).box) ? 1 : 0;
    }
    EXPECT_GE(found.size(), expected);
    EXPECT_TRUE(found.size() == expected || !world_.partition().is_exact());
  }
}

TEST_P(FilterChanges, cleared_partition_forgets_its_filters) {
  const std::vector<Aabb> boxes = uniform_boxes(scaled(200));
  const std::vector<Key> keys = world_.insert(boxes);
  world_.set_filter(keys, std::vector<ObjectFilter>(keys.size(), {kOther, kOther, 0}));
  expect_right_answers();
  world_.clear();
  const std::vector<Key> again = world_.insert(boxes);
  world_.set_filter(again[0], {kOther, 1, 0});
  expect_right_answers();
}

INSTANTIATE_TEST_SUITE_P(All, FilterChanges, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
