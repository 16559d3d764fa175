// Boxes and client data as input: which are refused, and in which layouts boxes may come.

#include <winnow/core/eigen.h>
#include <cmath>
#include <limits>

#include "tests/partitions/snapshot.h"
#include "tests/support/answers.h"
#include "tests/support/hostile_scenes.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"

namespace winnow::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

float& coordinate(Aabb& box, int i) {
  return i < 3 ? box.min[i] : box.max[i - 3];
}

// Returns one box for each way to be invalid.
std::vector<Aabb> invalid_boxes() {
  const Aabb good{{0, 0, 0}, {1, 1, 1}};
  std::vector<Aabb> bad{Aabb{}};
  for (int i = 0; i < 6; ++i) {
    for (const float nan : {kNan, -kNan}) {
      bad.push_back(good);
      coordinate(bad.back(), i) = nan;
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    bad.push_back(good);
    bad.back().min[axis] = std::nextafter(1.0F, 2.0F);  // inverted by one ulp
    bad.push_back(good);
    bad.back().min[axis] = bad.back().max[axis] = kInf;
    bad.push_back(good);
    bad.back().min[axis] = bad.back().max[axis] = -kInf;
    bad.push_back(good);
    bad.back().min[axis] = kInf;
    bad.back().max[axis] = -kInf;
  }
  return bad;
}

class Input : public Conformance {
 protected:
  Input() : boxes_(uniform_boxes(50)), world_(config()), keys_(world_.insert(boxes_)) {}

  std::vector<Aabb> boxes_;
  World world_;
  std::vector<Key> keys_;
};

TEST_P(Input, invalid_box_changes_nothing) {
  Snapshot before(world_);
  Partition& p = world_.partition();
  for (const Aabb& bad : invalid_boxes()) {
    SCOPED_TRACE(testing::Message()
                 << as_eigen(bad.min).transpose() << " .. " << as_eigen(bad.max).transpose());
    Key key{5, 6};
    EXPECT_TRUE(before.refused(p.insert(bad, 1).get(key), Status::invalid_bounds));
    EXPECT_EQ(key, (Key{5, 6})) << "a refused call wrote its output";
    EXPECT_TRUE(before.refused(p.update(keys_[7], bad), Status::invalid_bounds));
  }
}

TEST_P(Input, one_invalid_box_among_good_ones_changes_nothing) {
  Snapshot before(world_);
  Partition& p = world_.partition();
  for (const Aabb& bad : invalid_boxes()) {
    for (const std::size_t at : {std::size_t{0}, boxes_.size() / 2, boxes_.size() - 1}) {
      std::vector<Aabb> boxes = boxes_;
      for (Aabb& box : boxes) as_eigen(box.max).array() += 0.5F;
      boxes[at] = bad;
      std::vector<Key> keys(boxes.size());
      EXPECT_TRUE(before.refused(p.insert(boxes, {}, keys), Status::invalid_bounds));
      EXPECT_EQ(keys, std::vector<Key>(boxes.size())) << "a refused call wrote its output";
      EXPECT_TRUE(before.refused(p.update(keys_, boxes), Status::invalid_bounds));
    }
  }
}

TEST_P(Input, spans_of_different_lengths_change_nothing) {
  Snapshot before(world_);
  Partition& p = world_.partition();
  const std::span<const Aabb> boxes(boxes_);
  std::vector<Key> keys(boxes.size());
  const std::span<Key> all(keys);
  const std::vector<ClientData> data(boxes.size() + 1, 3);
  EXPECT_TRUE(before.refused(p.insert(boxes, {}, all.first(49)), Status::size_mismatch));
  EXPECT_TRUE(before.refused(p.insert(boxes.first(49), {}, all), Status::size_mismatch));
  EXPECT_TRUE(before.refused(p.insert(boxes, data, all), Status::size_mismatch));
  EXPECT_TRUE(before.refused(p.insert(boxes, {data.data(), 49}, all), Status::size_mismatch));
  EXPECT_TRUE(before.refused(p.insert(boxes, {}, {}), Status::size_mismatch));
  EXPECT_TRUE(before.refused(p.update(keys_, boxes.first(49)), Status::size_mismatch));
  EXPECT_TRUE(before.refused(p.update(std::span<const Key>(keys_).first(49), boxes),
                             Status::size_mismatch));
}

TEST_P(Input, empty_input_is_accepted) {
  Snapshot before(world_);
  Partition& p = world_.partition();
  EXPECT_TRUE(before.refused(p.insert(BoxView{}, {}, {}), Status::ok));
  EXPECT_TRUE(before.refused(p.update(std::span<const Key>{}, BoxView{}), Status::ok));
  EXPECT_TRUE(before.refused(p.remove(std::span<const Key>{}), Status::ok));
}

TEST_P(Input, columns_and_struct_members_are_read) {
  struct Body {
    double mass = 0.0;
    float low[3];
    int id = 0;
    float high[3];
  };
  std::vector<Body> bodies(boxes_.size());
  std::array<std::vector<float>, 6> columns;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      bodies[i].low[axis] = boxes_[i].min[axis];
      bodies[i].high[axis] = boxes_[i].max[axis];
      columns[static_cast<std::size_t>(axis)].push_back(boxes_[i].min[axis]);
      columns[static_cast<std::size_t>(axis) + 3].push_back(boxes_[i].max[axis]);
    }
  }
  const Body& b = bodies[0];
  const BoxView members({&b.low[0], &b.low[1], &b.low[2]}, {&b.high[0], &b.high[1], &b.high[2]},
                        bodies.size(), sizeof(Body));
  const BoxView soa({columns[0].data(), columns[1].data(), columns[2].data()},
                    {columns[3].data(), columns[4].data(), columns[5].data()}, boxes_.size());
  for (const BoxView& view : {members, soa}) {
    World world(config());
    const std::vector<Key> keys = world.insert(std::vector<Aabb>(boxes_.rbegin(), boxes_.rend()));
    // The model gets an array of boxes; the partition gets this layout.
    world.update(keys, boxes_);
    ASSERT_EQ(world.partition().update(keys, view), Status::ok);
    EXPECT_TRUE(world.holds_its_objects());
    EXPECT_TRUE(world.agrees());
    auto fresh = config().make();
    std::vector<Key> others(view.count);
    ASSERT_EQ(fresh.insert(view, {}, others), Status::ok);
    for (std::size_t i = 0; i < others.size(); ++i) {
      Aabb box = expect_ok(fresh.bounds(others[i]));
      EXPECT_EQ(box, boxes_[i]);
    }
  }
}

// If columns hold all objects, an update may select some of them, by list or by mask, in any share
// and with any gaps.
TEST_P(Input, entries_may_select_from_columns_of_all) {
  std::vector<Aabb> boxes = uniform_boxes(700);
  for (const bool fat : {false, true}) {
    Partition listed(structure_named(config().partition),
                     {.execution = config().execution(), .fat_margin = {fat ? 0.01F : 0.0F, 0.0F}});
    Partition masked(structure_named(config().partition),
                     {.execution = config().execution(), .fat_margin = {fat ? 0.01F : 0.0F, 0.0F}});
    Partition plain(structure_named(config().partition),
                    {.execution = config().execution(), .fat_margin = {fat ? 0.01F : 0.0F, 0.0F}});
    std::vector<Key> keys[3];
    Partition* const all[] = {&listed, &masked, &plain};
    for (std::size_t p = 0; p < 3; ++p) {
      keys[p].resize(boxes.size());
      ASSERT_EQ(all[p]->insert(boxes, {}, keys[p]), Status::ok);
    }
    Random random(6);
    for (const double share : {0.0, 0.01, 0.3, 0.6, 0.99, 1.0}) {
      std::vector<std::uint32_t> numbers;
      std::vector<std::uint64_t> words((boxes.size() + 63) / 64);
      words.back() = ~std::uint64_t{0} << boxes.size() % 64;  // beyond the last entry
      std::vector<Key> some_keys;
      std::vector<Aabb> some_boxes;
      const std::vector<Aabb> next = uniform_boxes(boxes.size(), random.bits());
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (!random.chance(share)) continue;
        numbers.push_back(static_cast<std::uint32_t>(i));
        words[i / 64] |= std::uint64_t{1} << i % 64;
        some_keys.push_back(keys[2][i]);
        some_boxes.push_back(next[i]);
      }
      ASSERT_EQ(listed.update(keys[0], next, IndexSubset::listed(numbers)), Status::ok);
      ASSERT_EQ(masked.update(keys[1], next, IndexSubset::masked(words)), Status::ok);
      ASSERT_EQ(plain.update(some_keys, some_boxes), Status::ok);
      PairBuffer pairs[3];
      for (std::size_t p = 0; p < 3; ++p) {
        ASSERT_EQ(all[p]->self_pairs(pairs[p], {.order = Order::canonical}), Status::ok);
        EXPECT_TRUE(std::ranges::equal(pairs[p], pairs[0])) << "share " << share;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
          Aabb box;
          Aabb same;
          box = expect_ok(all[p]->bounds(keys[p][i]));
          same = expect_ok(listed.bounds(keys[0][i]));
          ASSERT_EQ(box, same);
        }
      }
    }
    // Entries may be in any order. Entry 9 is listed twice; the last one counts, and both are
    // equal.
    const std::vector<std::uint32_t> back{9, 3, 9, 1};
    EXPECT_EQ(listed.update(keys[0], boxes, IndexSubset::listed(back)), Status::ok);
  }
}

// There are as many entries as objects, but one object has two entries and another none; all
// objects jump, so that no row order is worth keeping.
TEST_P(Input, object_given_twice_takes_its_last_box) {
  const std::vector<Aabb> boxes = uniform_boxes(700);
  const std::vector<Aabb> next = uniform_boxes(700, 8);
  Partition partition(structure_named(config().partition), {.execution = config().execution()});
  std::vector<Key> keys(boxes.size());
  ASSERT_EQ(partition.insert(boxes, {}, keys), Status::ok);
  PairBuffer pairs;
  ASSERT_EQ(partition.self_pairs(pairs), Status::ok);
  std::vector<Key> with_repeat = keys;
  with_repeat[500] = keys[20];
  ASSERT_EQ(partition.update(with_repeat, next), Status::ok);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    Aabb box = expect_ok(partition.bounds(keys[i]));
    EXPECT_EQ(box, i == 20 ? next[500] : i == 500 ? boxes[500] : next[i]) << i;
  }
}

// Runs of consecutive entries may come in any order.
TEST_P(Input, runs_of_entries_in_any_order_are_right) {
  constexpr std::uint32_t kRuns[][2] = {{100, 250}, {300, 700}, {251, 299}, {0, 90}, {290, 310}};
  const std::vector<Aabb> boxes = uniform_boxes(700);
  const std::vector<Aabb> next = uniform_boxes(700, 8);
  for (const float margin : {0.0F, 0.01F}) {
    for (std::size_t runs = 1; runs <= std::size(kRuns); ++runs) {
      Partition listed(structure_named(config().partition),
                       {.execution = config().execution(), .fat_margin = {margin, 0.0F}});
      Partition plain(structure_named(config().partition),
                      {.execution = config().execution(), .fat_margin = {margin, 0.0F}});
      std::vector<Key> keys[2]{std::vector<Key>(700), std::vector<Key>(700)};
      ASSERT_EQ(listed.insert(boxes, {}, keys[0]), Status::ok);
      ASSERT_EQ(plain.insert(boxes, {}, keys[1]), Status::ok);
      // One object twice, at the ends of a run: its last box counts.
      for (auto& of_one : keys) of_one[699] = of_one[300];
      std::vector<std::uint32_t> numbers;
      for (std::size_t run = 0; run < runs; ++run) {
        for (std::uint32_t i = kRuns[run][0]; i < kRuns[run][1]; ++i) {
          numbers.push_back(i);
          ASSERT_EQ(plain.update(keys[1][i], next[i]), Status::ok);
        }
      }
      ASSERT_EQ(listed.update(keys[0], next, IndexSubset::listed(numbers)), Status::ok);
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        Aabb box;
        Aabb same;
        box = expect_ok(listed.bounds(keys[0][i]));
        same = expect_ok(plain.bounds(keys[1][i]));
        ASSERT_EQ(box, same) << i << " after " << runs << " runs";
      }
    }
  }
}

TEST_P(Input, invalid_entries_change_nothing) {
  World world(config());
  const std::vector<Key> keys = world.insert(boxes_);
  std::vector<Aabb> next(boxes_.rbegin(), boxes_.rend());
  const std::vector<std::uint32_t> beyond{0, static_cast<std::uint32_t>(boxes_.size())};
  const std::vector<std::uint32_t> first_two{0, 1};
  const std::vector<std::uint64_t> few;
  Partition& partition = world.partition();
  EXPECT_EQ(partition.update(keys, next, IndexSubset::listed(beyond)), Status::invalid_argument);
  EXPECT_EQ(partition.update(keys, next, IndexSubset::masked(few)), Status::size_mismatch);
  next.pop_back();
  EXPECT_EQ(partition.update(keys, next, IndexSubset::listed(first_two)), Status::size_mismatch);
  next.push_back({{1, 0, 0}, {0, 1, 1}});
  next[1] = next.back();
  EXPECT_EQ(partition.update(keys, next, IndexSubset::listed(first_two)), Status::invalid_bounds);
  EXPECT_TRUE(world.holds_its_objects());
  EXPECT_TRUE(world.agrees());
}

TEST_P(Input, invalid_box_anywhere_in_a_list_changes_nothing) {
  World world(config());
  const std::vector<Aabb> boxes = uniform_boxes(3 * 37, 7);
  const std::vector<Key> keys = world.insert(boxes);
  // Selects every third entry, so that list neighbours are not memory neighbours.
  std::vector<std::uint32_t> every_third;
  for (std::uint32_t i = 0; i < 37; ++i) every_third.push_back(3 * i);
  constexpr float inf = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const Aabb illegal[] = {{{1, 0, 0}, {0, 1, 1}},
                          {{0, 0, 0}, {1, nan, 1}},
                          {{0, 0, inf}, {1, 1, inf}},
                          {{-inf, 0, 0}, {-inf, 1, 1}}};
  for (const Aabb& wrong : illegal) {
    for (const std::uint32_t at : every_third) {
      std::vector<Aabb> next = boxes;
      next[at] = wrong;
      ASSERT_EQ(world.partition().update(keys, next, IndexSubset::listed(every_third)),
                Status::invalid_bounds);
    }
    // A box that no entry selects is not read.
    std::vector<Aabb> next = boxes;
    next[1] = wrong;
    EXPECT_EQ(world.partition().update(keys, next, IndexSubset::listed(every_third)), Status::ok);
  }
  EXPECT_TRUE(world.holds_its_objects());
  EXPECT_TRUE(world.agrees());
}

TEST_P(Input, duplicate_client_data_makes_two_objects) {
  World world(config());
  const std::vector<ClientData> data(boxes_.size(), 42);
  const std::vector<Key> keys = world.insert(boxes_, data);
  EXPECT_TRUE(world.holds_its_objects());
  EXPECT_TRUE(world.agrees());
  world.remove(keys[0]);
  EXPECT_EQ(world.partition().size(), boxes_.size() - 1);
  EXPECT_TRUE(world.holds_its_objects());
}

TEST_P(Input, boxes_and_data_read_back_bit_identical) {
  World world(config());
  for (const std::vector<Scene>* scenes : {&infinite_scenes(), &extreme_float_scenes()}) {
    for (const Scene& scene : *scenes) {
      std::vector<ClientData> data;
      for (std::size_t i = 0; i < scene.boxes.size(); ++i) data.push_back(~ClientData{0} - i);
      world.insert(scene.boxes, data);
      EXPECT_TRUE(world.holds_its_objects()) << scene.name;
    }
  }
  const Status status = world.threads().run([&] { return world.partition().refresh(); });
  ASSERT_EQ(status, Status::ok);
  EXPECT_TRUE(world.holds_its_objects()) << "after the structure was made";
}

TEST_P(Input, reserve_does_not_limit_the_object_count) {
  World world(config());
  ASSERT_EQ(world.partition().reserve(1000), Status::ok);
  EXPECT_EQ(world.partition().size(), 0U);
  world.insert(uniform_boxes(700));
  ASSERT_EQ(world.partition().reserve(10), Status::ok);
  world.insert(uniform_boxes(700, 2));
  EXPECT_TRUE(world.holds_its_objects());
  EXPECT_TRUE(world.agrees());
}

INSTANTIATE_TEST_SUITE_P(All, Input, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
