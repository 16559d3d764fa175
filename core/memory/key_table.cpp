// Slots and stamps of keys: acquire, release, validation of batches, restore from a snapshot.

#include "core/memory/key_table.h"

#include "core/memory/columns.h"
#include "core/sort/parallel_ranges.h"

#include <algorithm>

namespace winnow {

KeyTable::KeyTable(std::pmr::memory_resource* memory) noexcept
    : stamps_(memory), rows_(memory), data_(memory), stamp_(tags_.latest() << kGenerationBits) {}

bool KeyTable::reserve(std::size_t count) noexcept {
  const std::size_t fresh = count > live_ ? count - live_ : 0;
  return reserve_slots(slots_with(fresh));
}

void KeyTable::touch() noexcept {
  touch_columns(stamps_, rows_, data_);
}

Key KeyTable::acquire(std::uint32_t row, ClientData data) noexcept {
  ObjectId id = first_free_;
  if (id != kNoObject) {
    first_free_ = rows_[id];
    --free_count_;
    ++stamps_[id];
  } else {
    id = static_cast<ObjectId>(stamps_.size());
    stamps_.set_size(id + std::size_t{1});
    rows_.set_size(id + std::size_t{1});
    data_.set_size(id + std::size_t{1});
    stamps_[id] = stamp_ | 1U;
  }
  rows_[id] = row;
  data_[id] = data;
  ++live_;
  return {id, stamps_[id]};
}

void KeyTable::acquire(std::uint32_t row, std::span<const ClientData> data, std::span<Key> keys,
                       const Execution& execution) noexcept {
  constexpr std::size_t kKeysPerTask = 8192;
  const auto data_of = [&](std::size_t i) { return data.empty() ? 0 : data[i]; };
  const auto row_at = [&](std::size_t i) { return row + static_cast<std::uint32_t>(i); };
  std::size_t reused = 0;
  for (; reused < keys.size() && first_free_ != kNoObject; ++reused) {
    keys[reused] = acquire(row_at(reused), data_of(reused));
  }
  const std::size_t first = stamps_.size();
  const std::size_t slots = first + keys.size() - reused;
  stamps_.set_size(slots);
  rows_.set_size(slots);
  data_.set_size(slots);
  for_each_even_range(execution, slots - first, kKeysPerTask,
                      [&](std::size_t begin, std::size_t end) {
                        for (std::size_t slot = first + begin; slot < first + end; ++slot) {
                          const std::size_t i = reused + slot - first;
                          stamps_[slot] = stamp_ | 1U;
                          rows_[slot] = row_at(i);
                          data_[slot] = data_of(i);
                          keys[i] = {static_cast<ObjectId>(slot), stamps_[slot]};
                        }
                      });
  live_ += slots - first;
}

// The loops of the next three functions have no unpredictable branches.

KeyTable::KeysCheck KeyTable::check_keys(std::span<const Key> keys) const noexcept {
  if (keys.empty()) return {};
  std::uint32_t falls = 0;
  for (std::size_t i = 1; i < keys.size(); ++i) falls |= keys[i - 1].id < keys[i].id ? 0U : 1U;
  if (falls != 0) return {.valid = are_valid(keys), .ascending = false};
  const bool known = keys.back().id < stamps_.size();
  return {.valid = known && are_valid_ascending(keys), .ascending = true};
}

bool KeyTable::are_valid(std::span<const Key> keys) const noexcept {
  if (stamps_.empty()) return false;
  std::uint32_t wrong = 0;
  for (const Key key : keys) {
    const std::uint32_t unknown = key.id < stamps_.size() ? 0U : 1U;
    wrong |= (stamps_[unknown != 0 ? 0 : key.id] ^ key.stamp) | unknown | (~key.stamp & 1U);
  }
  return wrong == 0;
}

/// Requires ascending ids, the last one below the number of slots.
bool KeyTable::are_valid_ascending(std::span<const Key> keys) const noexcept {
  std::uint32_t wrong = 0;
  const ObjectId first = keys.front().id;
  if (keys.back().id - first + std::size_t{1} == keys.size()) {
    // Consecutive ids need no lookups, only a comparison of two columns.
    const std::uint32_t* const stamps = stamps_.data() + first;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      wrong |= (keys[i].stamp ^ stamps[i]) | (~stamps[i] & 1U);
    }
  } else {
    const std::uint32_t* const stamps = stamps_.data();
    const auto wrongs_of = [&](const Key& key, std::uint32_t stamp) {
      wrong |= (stamp ^ key.stamp) | (~key.stamp & 1U);
    };
    // Ids of most groups of four are consecutive, and their stamps are then adjacent.
    constexpr std::size_t kFew = 4;
    std::size_t i = 0;
    for (; i + kFew <= keys.size(); i += kFew) {
      const Key* const few = keys.data() + i;
      if (few[kFew - 1].id - few[0].id == kFew - 1) {
        for (std::size_t k = 0; k < kFew; ++k) wrongs_of(few[k], stamps[few[0].id + k]);
      } else {
        for (std::size_t k = 0; k < kFew; ++k) wrongs_of(few[k], stamps[few[k].id]);
      }
    }
    for (; i < keys.size(); ++i) wrongs_of(keys[i], stamps[keys[i].id]);
  }
  return wrong == 0;
}

void KeyTable::release(ObjectId id) noexcept {
  --live_;
  const std::uint32_t uses = uses_before(stamps_[id]);
  if (uses < most_uses()) {
    ++stamps_[id];
  } else {
    const bool retired = uses == most_uses() && !tags_.renew();
    if (uses == most_uses() && !retired) stamp_ = tags_.latest() << kGenerationBits;
    stamps_[id] = stamp_;  // even: dead
    if (retired) return;
  }
  rows_[id] = first_free_;
  first_free_ = id;
  ++free_count_;
}

void KeyTable::clear() noexcept {
  for (std::size_t slot = stamps_.size(); slot-- > 0;) {
    if (is_live(static_cast<ObjectId>(slot))) release(static_cast<ObjectId>(slot));
  }
}

void KeyTable::release_if_unused() noexcept {
  if (live_ == 0 && stamps_.empty()) {
    release_columns(stamps_, rows_, data_);
  }
}

bool KeyTable::are_consistent(const SavedSlots& saved, Column<std::uint8_t>& seen) noexcept {
  const std::size_t slots = saved.stamps.size();
  if (saved.data.size() != slots || (saved.stamp & 1U) != 0) return false;
  std::fill_n(seen.data(), slots, std::uint8_t{0});
  for (const ObjectId id : saved.free) {
    if (id >= slots || (saved.stamps[id] & 1U) != 0 || seen[id] != 0) return false;
    seen[id] = 1;
  }
  return true;
}

std::uint32_t KeyTable::stamp_beyond(const SavedSlots& saved) noexcept {
  std::uint32_t uses = 0;
  const auto pass = [&](std::uint32_t stamp) {
    const std::uint32_t before = uses_before(stamp);
    if (before <= most_uses()) uses = std::max(uses, before + (stamp & 1U));
  };
  for (const std::uint32_t stamp : stamps_) pass(stamp);
  for (const std::uint32_t stamp : saved.stamps) pass(stamp);
  pass(saved.stamp);
  if (uses <= most_uses()) return stamp_ + uses;
  // If no other tag is free, slots begin with the first generation again.
  (void)tags_.renew();
  return tags_.latest() << kGenerationBits;
}

void KeyTable::restore(const SavedSlots& saved, KeyTable& other) noexcept {
  const std::uint32_t begin = other.stamp_beyond(saved);
  tags_.swap(other.tags_);
  other.stamp_ = stamp_;
  stamp_ = begin;
  const std::size_t slots = saved.stamps.size();
  stamps_.set_size(slots);
  rows_.set_size(slots);
  data_.set_size(slots);
  std::uint32_t known = 0;  // the tag that was claimed last
  std::uint32_t row = 0;
  for (std::size_t slot = 0; slot < slots; ++slot) {
    const std::uint32_t stamp = saved.stamps[slot];
    const bool is_live = (stamp & 1U) != 0;
    const std::uint32_t tag = stamp >> kGenerationBits;
    if (is_live && tag != known && tags_.claim(tag)) known = tag;
    stamps_[slot] = !is_live ? stamp_ : tag == known ? stamp : stamp_ | 1U;
    data_[slot] = saved.data[slot];
    rows_[slot] = is_live ? row++ : kNoObject;
  }
  live_ = row;
  free_count_ = saved.free.size();
  first_free_ = saved.free.empty() ? kNoObject : saved.free.front();
  for (std::size_t i = 0; i < saved.free.size(); ++i) {
    rows_[saved.free[i]] = i + 1 < saved.free.size() ? saved.free[i + 1] : kNoObject;
  }
}

Bytes KeyTable::key_bytes() const noexcept {
  return bytes_of(stamps_, rows_);
}

}  // namespace winnow
