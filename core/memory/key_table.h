#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include <winnow/core/key.h>
#include <winnow/core/status.h>
#include "core/memory/key_tags.h"

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Keys of one partition: slot -> (stamp, row, client data). A removed slot's row links the free
/// list, so keys cost 8 bytes per slot and no search. Live stamps have an odd generation, which
/// lets a forged key never reach a free slot.
class KeyTable {
 public:
  explicit KeyTable(std::pmr::memory_resource* memory) noexcept;

  /// Room for `count` live objects in all. False, and unchanged, if memory is refused.
  [[nodiscard]] bool reserve(std::size_t count) noexcept;

  /// Slots that there are once so many more objects have got theirs.
  [[nodiscard]] std::size_t slots_with(std::size_t fresh) const noexcept {
    return stamps_.size() + (fresh > free_count_ ? fresh - free_count_ : 0);
  }

  /// Writes to the pages behind the slots.
  void touch() noexcept;

  /// Takes a free slot for an object at `row`; room must have been reserved.
  [[nodiscard]] Key acquire(std::uint32_t row, ClientData data) noexcept;

  /// The same for objects in rows from `row` on, one for each of `keys`; no `data` are all zero.
  void acquire(std::uint32_t row, std::span<const ClientData> data, std::span<Key> keys,
               const Execution& execution) noexcept;

  /// Frees the slot of a valid key. A slot out of generations goes on with another tag, or is
  /// retired if the process has none left.
  void release(ObjectId id) noexcept;

  /// Frees every slot; all keys become stale.
  void clear() noexcept;

  /// Gives unused memory back. The stamps of used slots stay: they are what tells a stale key.
  void release_if_unused() noexcept;

  [[nodiscard]] bool is_valid(Key key) const noexcept {
    return key.id < stamps_.size() && stamps_[key.id] == key.stamp && (key.stamp & 1U) != 0;
  }
  /// What is_valid says of keys that follow each other.
  struct RunOfKeys {
    bool valid = true;      ///< all of them
    bool ascending = true;  ///< by id
  };
  [[nodiscard]] RunOfKeys look_at(std::span<const Key> keys) const noexcept;
  [[nodiscard]] bool is_live(ObjectId id) const noexcept {
    return id < stamps_.size() && (stamps_[id] & 1U) != 0;
  }
  [[nodiscard]] Key key_of(ObjectId id) const noexcept {
    return is_live(id) ? Key{id, stamps_[id]} : Key{};
  }

  [[nodiscard]] std::uint32_t row_of(ObjectId id) const noexcept { return rows_[id]; }
  void set_row(ObjectId id, std::uint32_t row) noexcept { rows_[id] = row; }
  [[nodiscard]] std::uint32_t* rows() noexcept { return rows_.data(); }
  [[nodiscard]] const std::uint32_t* rows() const noexcept { return rows_.data(); }
  [[nodiscard]] ClientData client_data(ObjectId id) const noexcept { return data_[id]; }
  /// Has what `key_of` and `client_data` read brought near.
  void fetch(ObjectId id) const noexcept {
    __builtin_prefetch(stamps_.data() + id);
    __builtin_prefetch(data_.data() + id);
  }

  /// Live objects.
  [[nodiscard]] std::size_t size() const noexcept { return live_; }
  /// Slots ever used; every ObjectId is below it.
  [[nodiscard]] std::size_t slot_count() const noexcept { return stamps_.size(); }
  /// Slots that there is room for.
  [[nodiscard]] std::size_t capacity() const noexcept { return stamps_.capacity(); }

  // What is saved and restored.

  /// By slot. Those of free slots are even.
  [[nodiscard]] std::span<const std::uint32_t> stamps() const noexcept {
    return {stamps_.data(), stamps_.size()};
  }
  [[nodiscard]] std::span<const ClientData> all_client_data() const noexcept {
    return {data_.data(), data_.size()};
  }
  /// The stamp before the first one of a slot: even, and beyond all stamps of its tag that slots
  /// had before the latest restore.
  [[nodiscard]] std::uint32_t stamp() const noexcept { return stamp_; }
  /// The free slot that is taken next, and the one after a free slot; kNoObject: none.
  [[nodiscard]] ObjectId first_free() const noexcept { return first_free_; }
  [[nodiscard]] ObjectId next_free(ObjectId id) const noexcept { return rows_[id]; }

  /// Slots as a table had them.
  struct Saved {
    std::span<const std::uint32_t> stamps;
    std::span<const ClientData> data;
    std::span<const ObjectId> free;  ///< in the order in which they are taken
    std::uint32_t stamp = 0;
  };
  /// True if they can have been a table's: live stamps are odd, those of free slots even, each free
  /// slot is listed once. `seen` is scratch of a byte a slot.
  [[nodiscard]] static bool are_slots(const Saved& saved, Column<std::uint8_t>& seen) noexcept;
  /// Room for so many slots. False, and unchanged, if memory is refused.
  [[nodiscard]] bool reserve_slots(std::size_t slots) noexcept {
    return stamps_.grow(slots) && rows_.grow(slots) && data_.grow(slots);
  }
  /// Becomes such a table, with room for it made, objects in rows by id. Takes the tags of `other`,
  /// which may be this one and gets its own: keys are the saved ones as long as no third table has
  /// their tags. Keys that follow differ from the saved ones and from all that either table gave.
  void restore(const Saved& saved, KeyTable& other) noexcept;

  [[nodiscard]] std::pmr::memory_resource* key_memory() const noexcept { return rows_.memory(); }
  [[nodiscard]] Bytes key_bytes() const noexcept;
  [[nodiscard]] Bytes client_data_bytes() const noexcept { return data_.bytes(); }

 private:
  [[nodiscard]] bool are_valid(std::span<const Key> keys) const noexcept;
  [[nodiscard]] bool are_valid_ascending(std::span<const Key> keys) const noexcept;

  /// A stamp that slots may begin with after a restore, see `stamp`.
  [[nodiscard]] std::uint32_t stamp_beyond(const Saved& saved) noexcept;
  /// Generations from `stamp_` up to this stamp, more than there are if it is none of those.
  [[nodiscard]] std::uint32_t uses_before(std::uint32_t stamp) const noexcept {
    return stamp - stamp_;
  }
  /// Generations that follow `stamp_` under its tag.
  [[nodiscard]] std::uint32_t most_uses() const noexcept {
    return (stamp_ | kGenerationMask) - stamp_;
  }

  static constexpr unsigned kGenerationBits = 32 - KeyTags::kBits;
  static constexpr std::uint32_t kGenerationMask = (1U << kGenerationBits) - 1;

  Column<std::uint32_t> stamps_;
  Column<std::uint32_t> rows_;
  Column<ClientData> data_;
  std::size_t live_ = 0;
  std::size_t free_count_ = 0;
  ObjectId first_free_ = kNoObject;
  KeyTags tags_;
  std::uint32_t stamp_;  // under a tag of its own, see `stamp`
};

}  // namespace winnow
