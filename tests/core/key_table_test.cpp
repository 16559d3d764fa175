// KeyTable and PartitionTagPool: no key is issued twice, even after a slot is reused or the table
// is cleared or restored; stale and foreign keys are invalid; refused memory changes nothing.

#include "core/memory/key_table.h"
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "tests/support/counting_memory.h"
#include "tests/support/platform.h"

#if WINNOW_TEST_THREADS
#include <thread>
#endif

namespace winnow::test {
namespace {

constexpr std::uint32_t kGenerations = 1U << (32U - PartitionTagPool::kBits);

std::vector<Key> fill(KeyTable& table, std::uint32_t count) {
  EXPECT_TRUE(table.reserve(table.size() + count));
  std::vector<Key> keys;
  for (std::uint32_t i = 0; i < count; ++i) keys.push_back(table.acquire(i, 100 + i));
  return keys;
}

TEST(KeyTable, fresh_table_gives_consecutive_ids) {
  CountingMemory memory;
  KeyTable table(&memory);
  const std::vector<Key> keys = fill(table, 50);
  for (std::uint32_t i = 0; i < 50; ++i) {
    EXPECT_EQ(keys[i].id, i);
    EXPECT_TRUE(table.is_valid(keys[i]));
    EXPECT_TRUE(table.is_live(i));
    EXPECT_EQ(table.key_of(i), keys[i]);
    EXPECT_EQ(table.row_of(i), i);
    EXPECT_EQ(table.client_data(i), 100 + i);
  }
  EXPECT_EQ(table.size(), 50U);
}

TEST(KeyTable, batch_of_keys_equals_single_keys) {
  CountingMemory memory;
  KeyTable table(&memory);
  const std::vector<Key> old = fill(table, 5);
  table.release(old[1].id);
  table.release(old[3].id);
  ASSERT_TRUE(table.reserve(7));
  std::vector<Key> keys(4);
  const std::vector<ClientData> data{10, 11, 12, 13};
  table.acquire(20, data, keys, Execution::parallel());
  EXPECT_EQ(table.size(), 7U);
  EXPECT_EQ(keys[0].id, 3U);  // freed ids, the last freed one first
  EXPECT_EQ(keys[1].id, 1U);
  EXPECT_EQ(keys[2].id, 5U);
  EXPECT_EQ(keys[3].id, 6U);
  for (std::uint32_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(table.is_valid(keys[i]));
    EXPECT_EQ(table.row_of(keys[i].id), 20 + i);
    EXPECT_EQ(table.client_data(keys[i].id), data[i]);
  }
}

TEST(KeyTable, batch_check_finds_invalid_and_unordered_keys) {
  CountingMemory memory;
  KeyTable table(&memory);
  const std::vector<Key> keys = fill(table, 40);
  const auto check_keys = [&](std::vector<Key> some) {
    const KeyTable::KeysCheck run = table.check_keys(some);
    return std::pair(run.valid, run.ascending);
  };
  EXPECT_EQ(check_keys({}), std::pair(true, true));
  EXPECT_EQ(check_keys(keys), std::pair(true, true));
  EXPECT_EQ(check_keys({keys[3], keys[5]}), std::pair(true, true));
  EXPECT_EQ(check_keys({keys[5], keys[5]}), std::pair(true, false));
  EXPECT_EQ(check_keys({keys[5], keys[4]}), std::pair(true, false));
  EXPECT_FALSE(check_keys({keys[38], keys[39], Key{40, keys[0].stamp}}).first);
  EXPECT_FALSE(check_keys({Key{}, Key{}}).first);
  EXPECT_FALSE(check_keys({keys[0], Key{}}).first);
  table.release(keys[20].id);
  EXPECT_FALSE(check_keys(keys).first);
  EXPECT_TRUE(check_keys({keys.begin(), keys.begin() + 20}).first);
}

TEST(KeyTable, batch_check_equals_the_check_of_each) {
  CountingMemory memory;
  KeyTable table(&memory);
  const std::vector<Key> keys = fill(table, 300);
  for (const Key key : keys) {
    if (key.id % 41 == 7) table.release(key.id);
  }
  std::mt19937 random(3);
  for (int round = 0; round < 2000; ++round) {
    // Takes most keys of a range; some may be stale, foreign or out of order.
    const std::size_t gaps = 2 + random() % 20;
    std::vector<Key> some;
    for (std::size_t i = random() % 290; i < keys.size() && some.size() < 40; ++i) {
      if (random() % gaps != 0 && (round % 2 == 0 || table.is_valid(keys[i]))) {
        some.push_back(keys[i]);
      }
    }
    if (!some.empty() && round % 5 == 0) some[random() % some.size()].stamp ^= 2U;
    if (!some.empty() && round % 7 == 0) some.back().id = 300;
    if (!some.empty() && round % 3 == 0)
      std::swap(some[random() % some.size()], some[random() % some.size()]);
    const KeyTable::KeysCheck run = table.check_keys(some);
    const auto is_valid = [&](Key key) { return table.is_valid(key); };
    EXPECT_EQ(run.valid, std::ranges::all_of(some, is_valid));
    const auto falls = [](Key a, Key b) { return a.id >= b.id; };
    EXPECT_EQ(run.ascending, std::ranges::adjacent_find(some, falls) == some.end());
  }
}

TEST(KeyTable, stale_foreign_and_forged_keys_are_invalid) {
  CountingMemory memory;
  KeyTable table(&memory);
  KeyTable other(&memory);
  const std::vector<Key> keys = fill(table, 10);
  const std::vector<Key> foreign = fill(other, 10);
  EXPECT_FALSE(table.is_valid(Key{}));
  EXPECT_FALSE(table.is_valid(foreign[3]));
  table.release(keys[3].id);
  EXPECT_FALSE(table.is_valid(keys[3]));
  EXPECT_FALSE(table.is_live(3));
  EXPECT_EQ(table.key_of(3), Key{});
  // A free slot accepts no stamp at all.
  for (std::uint32_t stamp = keys[3].stamp - 3; stamp != keys[3].stamp + 4; ++stamp) {
    EXPECT_FALSE(table.is_valid({3, stamp}));
  }
  EXPECT_FALSE(table.is_valid({10, keys[0].stamp}));
  EXPECT_FALSE(table.is_valid({kNoObject, keys[0].stamp}));
  EXPECT_FALSE(table.is_valid({kNoObject - 1, keys[0].stamp}));
  EXPECT_EQ(table.size(), 9U);
}

TEST(KeyTable, freed_ids_are_reused_first) {
  CountingMemory memory;
  KeyTable table(&memory);
  const std::vector<Key> keys = fill(table, 20);
  for (const ObjectId id : {4U, 9U, 14U}) table.release(id);
  std::set<ObjectId> again;
  for (const Key& key : fill(table, 3)) {
    again.insert(key.id);
    EXPECT_NE(key, keys[key.id]);
    EXPECT_FALSE(table.is_valid(keys[key.id]));
  }
  EXPECT_EQ(again, (std::set<ObjectId>{4, 9, 14}));
  EXPECT_EQ(table.slot_count(), 20U);
  EXPECT_EQ(fill(table, 1)[0].id, 20U);
}

TEST(KeyTable, reused_slot_gives_no_key_twice) {
  CountingMemory memory;
  KeyTable table(&memory);
  std::set<std::uint32_t> stamps;
  for (std::uint32_t use = 0; use < 2 * kGenerations; ++use) {
    const Key key = fill(table, 1)[0];
    ASSERT_EQ(key.id, 0U);
    ASSERT_TRUE(table.is_valid(key));
    ASSERT_TRUE(stamps.insert(key.stamp).second) << "a key was handed out twice";
    table.release(0);
    ASSERT_FALSE(table.is_valid(key));
  }
  EXPECT_EQ(table.slot_count(), 1U);
}

TEST(KeyTable, uneven_use_of_slots_gives_no_key_twice) {
  CountingMemory memory;
  KeyTable table(&memory);
  std::set<std::pair<ObjectId, std::uint32_t>> seen;
  std::vector<Key> keys = fill(table, 3);
  std::uint32_t uses[3] = {};
  for (std::uint32_t i = 0; i < 6 * kGenerations; ++i) {
    // Slot 0 is used most, slot 2 least.
    const ObjectId id = i % 7 == 0 ? 2 : i % 3 == 0 ? 1 : 0;
    ASSERT_TRUE(seen.emplace(id, keys[id].stamp).second) << id << " after " << uses[id];
    table.release(id);
    keys[id] = fill(table, 1)[0];
    ASSERT_EQ(keys[id].id, id);
    ++uses[id];
  }
  EXPECT_EQ(table.slot_count(), 3U);
}

TEST(KeyTable, worn_slot_is_retired_without_free_tags) {
  CountingMemory memory;
  std::vector<std::unique_ptr<PartitionTagPool>> all;
  for (std::uint32_t i = 0; i < PartitionTagPool::kMaxTags; ++i)
    all.push_back(std::make_unique<PartitionTagPool>());
  KeyTable table(&memory);
  const Key first = fill(table, 1)[0];
  Key last = first;
  std::size_t uses = 1;
  for (;;) {
    table.release(0);
    const Key next = fill(table, 1)[0];
    if (next.id != 0) break;
    ASSERT_NE(next, first) << "a key was handed out twice";
    last = next;
    ASSERT_LE(++uses, kGenerations);
  }
  EXPECT_EQ(uses, kGenerations / 2);
  EXPECT_FALSE(table.is_valid(first));
  EXPECT_FALSE(table.is_valid(last));
  EXPECT_FALSE(table.is_live(0));
  // The retired slot never returns, not even after a clear, and another slot takes its place.
  EXPECT_EQ(table.size(), 1U);
  EXPECT_EQ(table.slot_count(), 2U);
  table.clear();
  for (const Key& key : fill(table, 10)) EXPECT_NE(key.id, 0U);
  for (std::uint32_t stamp = 0; stamp < kGenerations; ++stamp) {
    ASSERT_FALSE(table.is_valid({0, (first.stamp & ~(kGenerations - 1)) | stamp}));
  }
}

TEST(PartitionTagPool, live_tags_are_unique) {
  std::vector<std::unique_ptr<PartitionTagPool>> alive;
  std::set<std::uint32_t> taken;
  std::mt19937 random(5);
  for (int step = 0; step < 300'000; ++step) {
    if (alive.size() < 100'000 && random() % 3 != 0) {
      alive.push_back(std::make_unique<PartitionTagPool>());
      ASSERT_TRUE(taken.insert(alive.back()->latest()).second);
    } else if (!alive.empty()) {
      std::swap(alive[random() % alive.size()], alive.back());
      taken.erase(alive.back()->latest());
      alive.pop_back();
    }
  }
  EXPECT_GT(alive.size(), 90'000U);
}

TEST(PartitionTagPool, freed_tag_is_reused_late) {
  std::uint32_t gone = 0;
  {
    const PartitionTagPool tags;
    gone = tags.latest();
  }
  for (std::uint32_t i = 0; i + 1 < PartitionTagPool::kMaxTags / 2; ++i) {
    const PartitionTagPool tags;
    ASSERT_NE(tags.latest(), gone) << "after " << i;
  }
}

#if WINNOW_TEST_THREADS
TEST(PartitionTagPool, threads_get_different_tags) {
  constexpr std::size_t kThreads = 4;
  std::vector<std::vector<std::unique_ptr<PartitionTagPool>>> made(kThreads);
  std::vector<std::thread> threads;
  for (auto& mine : made) {
    threads.emplace_back([&mine] {
      for (int i = 0; i < 5000; ++i) {
        mine.push_back(std::make_unique<PartitionTagPool>());
        if (i % 3 == 0) mine.erase(mine.begin());
        if (i % 5 == 1) {
          EXPECT_TRUE(mine.front()->renew());
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  std::set<std::uint32_t> taken;
  for (const auto& mine : made) {
    for (const auto& tags : mine) EXPECT_TRUE(taken.insert(tags->latest()).second);
  }
}
#endif

TEST(KeyTable, clear_makes_every_key_stale) {
  CountingMemory memory;
  KeyTable table(&memory);
  std::vector<Key> keys = fill(table, 100);
  table.release(7);
  table.clear();
  EXPECT_EQ(table.size(), 0U);
  const std::vector<Key> fresh = fill(table, 100);
  for (const Key& key : keys) EXPECT_FALSE(table.is_valid(key));
  for (const Key& key : fresh) EXPECT_TRUE(table.is_valid(key));
  EXPECT_EQ(table.slot_count(), 100U);
}

TEST(KeyTable, many_tables_give_no_key_twice) {
  CountingMemory memory;
  std::vector<std::unique_ptr<KeyTable>> tables;
  std::set<std::pair<ObjectId, std::uint32_t>> keys;
  for (int i = 0; i < 100'000; ++i) {
    tables.push_back(std::make_unique<KeyTable>(&memory));
    const Key key = fill(*tables.back(), 1)[0];
    ASSERT_TRUE(keys.emplace(key.id, key.stamp).second) << "tables " << i << " and an earlier one";
  }
}

// The data of a table that a snapshot stores.
struct SavedTable {
  explicit SavedTable(const KeyTable& table)
      : stamps(table.stamps().begin(), table.stamps().end()),
        data(table.all_client_data().begin(), table.all_client_data().end()),
        stamp(table.stamp()) {
    for (ObjectId id = table.first_free(); id != kNoObject; id = table.next_free(id)) {
      free.push_back(id);
    }
  }
  void load(KeyTable& table, KeyTable& other) const {
    ASSERT_TRUE(table.reserve_slots(stamps.size()));
    table.restore({stamps, data, free, stamp}, other);
  }

  std::vector<std::uint32_t> stamps;
  std::vector<ClientData> data;
  std::vector<ObjectId> free;
  std::uint32_t stamp;
};

// Random calls on a table that is saved and restored, in place or into another table: each key that
// the table issues is new, and each live key of a snapshot is valid again after the restore.
class RestoredTable {
 public:
  explicit RestoredTable(std::uint32_t seed) : random_(seed) { save(); }

  void step() {
    const std::uint32_t choice = static_cast<std::uint32_t>(random_()) % 100;
    if (choice < 45) {
      insert();
    } else if (choice < 90) {
      remove();
    } else if (choice < 94) {
      save();
    } else {
      load(choice % 2 == 0);
    }
  }
  // Uses one slot until its generations are used up.
  void wear() {
    for (std::uint32_t i = 0; i < kGenerations / 2 + 2; ++i) {
      insert();
      table_->release(keys_.back().id);
      keys_.pop_back();
    }
  }

 private:
  struct Kept {
    SavedTable table;
    std::vector<Key> keys;
  };

  void insert() {
    keys_.push_back(fill(*table_, 1)[0]);
    ASSERT_TRUE(given_.emplace(keys_.back().id, keys_.back().stamp).second) << "given twice";
  }
  void remove() {
    if (keys_.empty()) return;
    std::swap(keys_[random_() % keys_.size()], keys_.back());
    table_->release(keys_.back().id);
    ASSERT_FALSE(table_->is_valid(keys_.back()));
    keys_.pop_back();
  }
  void save() { kept_.push_back({SavedTable(*table_), keys_}); }
  void load(bool in_place) {
    const Kept& kept = kept_[random_() % kept_.size()];
    if (in_place) {
      kept.table.load(*table_, *table_);
    } else {
      auto fresh = std::make_unique<KeyTable>(&memory_);
      kept.table.load(*fresh, *table_);
      table_ = std::move(fresh);
    }
    keys_ = kept.keys;
    ASSERT_EQ(table_->size(), keys_.size());
    for (const Key& key : keys_) ASSERT_TRUE(table_->is_valid(key));
  }

  std::mt19937 random_;
  CountingMemory memory_;
  std::unique_ptr<KeyTable> table_ = std::make_unique<KeyTable>(&memory_);
  std::vector<Key> keys_;
  std::set<std::pair<ObjectId, std::uint32_t>> given_;
  std::vector<Kept> kept_;
};

TEST(KeyTable, restored_tables_give_no_key_twice) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    RestoredTable table(seed);
    for (int step = 0; step < 2000; ++step) {
      table.step();
      if (step % 500 == 250) table.wear();
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(KeyTable, table_restored_elsewhere_gives_no_saved_key) {
  CountingMemory memory;
  KeyTable saved(&memory);
  std::set<std::pair<ObjectId, std::uint32_t>> given;
  const auto use = [&](KeyTable& table) {
    for (const Key& key : fill(table, 3)) {
      EXPECT_TRUE(given.emplace(key.id, key.stamp).second);
      table.release(key.id);
    }
  };
  for (int i = 0; i < 5; ++i) use(saved);
  const SavedTable bytes(saved);
  KeyTable other(&memory);
  bytes.load(other, other);
  for (int i = 0; i < 5; ++i) use(other);
}

TEST(KeyTable, refused_memory_leaves_the_table_unchanged) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  for (std::size_t granted = 0; granted < 3; ++granted) {
    CountingMemory memory;
    KeyTable table(&memory);
    const std::vector<Key> keys = fill(table, 16);
    memory.refuse_after(granted);
    EXPECT_FALSE(table.reserve(100000)) << granted << " requests granted";
    memory.grant_all();
    EXPECT_EQ(table.size(), 16U);
    for (const Key& key : keys) EXPECT_TRUE(table.is_valid(key));
    Bytes total = table.key_bytes();
    total += table.client_data_bytes();
    EXPECT_EQ(total.reserved, memory.outstanding());
  }
}

}  // namespace
}  // namespace winnow::test
