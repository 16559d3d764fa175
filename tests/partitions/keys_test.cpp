// Keys: which keys are handed out, and how calls refuse invalid and stale keys.

#include <winnow/core/eigen.h>
#include <algorithm>
#include <set>

#include "tests/partitions/snapshot.h"
#include "tests/support/answers.h"
#include "tests/support/scenes.h"

namespace winnow::test {
namespace {

class Keys : public Conformance {
 protected:
  Keys() : boxes_(uniform_boxes(60)), world_(config()) { keys_ = world_.insert(boxes_); }

  // Expects that every call that takes a key refuses this one, singly and among good ones, and
  // changes nothing.
  void expect_refused(Key bad) {
    Snapshot before(world_);
    Partition& p = world_.partition();
    EXPECT_FALSE(p.contains(bad));
    const Aabb box{{7, 7, 7}, {8, 8, 8}};
    expect_error(p.bounds(bad), Status::invalid_key);
    EXPECT_EQ(p.client_data(bad), 0U);
    EXPECT_TRUE(before.refused(p.update(bad, box), Status::invalid_key));
    EXPECT_TRUE(before.refused(p.remove(bad), Status::invalid_key));
    for (const std::size_t at : {std::size_t{0}, keys_.size() / 2, keys_.size() - 1}) {
      std::vector<Key> keys = keys_;
      keys[at] = bad;
      std::vector<Aabb> elsewhere = boxes_;
      for (Aabb& moved : elsewhere) as_eigen(moved.max).array() += 1.0F;
      EXPECT_TRUE(before.refused(p.update(keys, elsewhere), Status::invalid_key)) << "at " << at;
      EXPECT_TRUE(before.refused(p.remove(keys), Status::invalid_key)) << "at " << at;
    }
  }

  // Removes an object, also from the test's list of live objects.
  Key remove_one(std::size_t i) {
    const Key key = keys_[i];
    world_.remove(key);
    keys_.erase(keys_.begin() + static_cast<std::ptrdiff_t>(i));
    boxes_.erase(boxes_.begin() + static_cast<std::ptrdiff_t>(i));
    return key;
  }

  std::vector<Aabb> boxes_;
  World world_;
  std::vector<Key> keys_;
};

TEST_P(Keys, fresh_partition_numbers_the_objects) {
  for (std::size_t i = 0; i < keys_.size(); ++i) EXPECT_EQ(keys_[i].id, i);
  EXPECT_TRUE(world_.holds_its_objects());
}

TEST_P(Keys, keys_are_never_null_and_never_repeated) {
  std::set<std::pair<ObjectId, std::uint32_t>> seen;
  for (int round = 0; round < 50; ++round) {
    const Key key = world_.insert(boxes_[0]);
    EXPECT_NE(key, Key{});
    EXPECT_TRUE(seen.emplace(key.id, key.stamp).second);
    world_.remove(key);
  }
}

TEST_P(Keys, stale_key_is_refused) {
  const Key stale = remove_one(20);
  expect_refused(stale);
  const Key reused = world_.insert(Aabb{{0, 0, 0}, {1, 1, 1}});
  EXPECT_EQ(reused.id, stale.id) << "a freed id is used again";
  expect_refused(stale);
}

TEST_P(Keys, default_key_is_refused) {
  expect_refused(Key{});
}

TEST_P(Keys, foreign_key_is_refused) {
  World other(config());
  const std::vector<Key> foreign = other.insert(boxes_);
  expect_refused(foreign[0]);
  expect_refused(foreign[59]);
}

TEST_P(Keys, forged_key_is_refused) {
  const Key good = keys_[30];
  for (const std::uint32_t stamp : {0U, 1U, good.stamp + 1, good.stamp + 2, good.stamp - 1,
                                    good.stamp ^ 0x80000000U, good.stamp ^ 0x00100000U, ~0U}) {
    expect_refused({good.id, stamp});
  }
  for (const ObjectId id : {ObjectId{60}, ObjectId{61}, ObjectId{1U << 20U}, ObjectId{1U << 31U},
                            kNoObject - 1, kNoObject}) {
    expect_refused({id, good.stamp});
  }
}

// A free slot must not accept any stamp, whatever is stored in it.
TEST_P(Keys, forged_key_of_a_free_slot_is_refused) {
  const Key stale = remove_one(10);
  for (std::uint32_t delta = 0; delta < 4; ++delta) expect_refused({stale.id, stale.stamp + delta});
}

TEST_P(Keys, clear_makes_keys_stale) {
  const std::vector<Key> before = keys_;
  world_.clear();
  keys_ = world_.insert(boxes_);
  for (const Key& key : keys_) EXPECT_LT(key.id, keys_.size()) << "ids are used again";
  expect_refused(before[0]);
  expect_refused(before[59]);
}

TEST_P(Keys, repeated_key_in_a_removal_is_refused) {
  Snapshot before(world_);
  for (const std::size_t at : {std::size_t{1}, keys_.size() / 2, keys_.size() - 1}) {
    std::vector<Key> keys = keys_;
    keys[at] = keys[0];
    EXPECT_TRUE(before.refused(world_.partition().remove(keys), Status::invalid_key));
  }
  world_.remove(keys_);
  EXPECT_TRUE(world_.agrees());
}

TEST_P(Keys, repeated_key_in_an_update_takes_last_box) {
  const std::vector<Key> twice{keys_[3], keys_[4], keys_[3]};
  const std::vector<Aabb> boxes{boxes_[10], boxes_[11], boxes_[12]};
  world_.update(twice, boxes);
  EXPECT_TRUE(world_.holds_its_objects());
  EXPECT_TRUE(world_.agrees());
}

// If nearly all objects are updated, rows are written in row order, whatever the order of the keys.
TEST_P(Keys, update_of_all_accepts_keys_in_any_order) {
  for (const std::size_t gone : {std::size_t{0}, std::size_t{5}}) {
    for (std::size_t i = 0; i < gone; ++i) remove_one(3 * i);
    std::vector<Key> keys(keys_.rbegin(), keys_.rend());
    std::vector<Aabb> boxes(boxes_.begin(), boxes_.end());
    world_.update(keys, boxes);
    EXPECT_TRUE(world_.holds_its_objects());
    EXPECT_TRUE(world_.agrees());
    std::rotate(keys.begin(), keys.begin() + 20, keys.end());
    keys.push_back(keys[7]);
    boxes.push_back(boxes_[40]);
    world_.update(keys, boxes);
    EXPECT_TRUE(world_.holds_its_objects());
    EXPECT_TRUE(world_.agrees());
  }
}

TEST_P(Keys, id_without_an_object_has_a_null_key) {
  const Key gone = remove_one(5);
  for (const ObjectId id : {gone.id, ObjectId{60}, ObjectId{1U << 31U}, kNoObject}) {
    EXPECT_EQ(world_.partition().key_of(id), Key{});
    EXPECT_EQ(world_.partition().client_data_of(id), 0U);
  }
}

TEST_P(Keys, keys_survive_the_removal_of_others) {
  for (const std::size_t i : {std::size_t{0}, std::size_t{57}, std::size_t{30}, std::size_t{0}}) {
    remove_one(i);
    EXPECT_TRUE(world_.holds_its_objects());
    EXPECT_TRUE(world_.agrees());
  }
  const std::vector<Key> half(keys_.begin(), keys_.begin() + 28);
  world_.remove(half);
  EXPECT_TRUE(world_.holds_its_objects());
  EXPECT_TRUE(world_.agrees());
}

INSTANTIATE_TEST_SUITE_P(All, Keys, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
