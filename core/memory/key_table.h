#pragma once

// KeyTable maps keys of a partition or scene to rows and client data, and detects stale keys. Rows
// (partitions/rows/) and SceneState own one each; saved_keys.h saves and reads it.
#include <winnow/core/execution.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include "core/memory/partition_tag_pool.h"

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Keys of one partition or scene: slot -> (stamp, row, client data). The rows of free slots link
/// the free list, so keys cost 8 bytes per slot and no search. Stamps of live slots are odd, stamps
/// of free slots even, and even stamps are rejected: no forged key reaches a free slot.
class KeyTable {
 public:
  explicit KeyTable(std::pmr::memory_resource* memory) noexcept;

  /// Reserves room for `count` live objects in total. Returns false, and changes nothing, if memory
  /// is refused.
  [[nodiscard]] bool reserve(std::size_t count) noexcept;

  /// Returns the number of slots after `fresh` more objects are added.
  [[nodiscard]] std::size_t slots_with(std::size_t fresh) const noexcept {
    return stamps_.size() + (fresh > free_count_ ? fresh - free_count_ : 0);
  }

  /// Prefaults the pages behind the slots.
  void touch() noexcept;

  /// Takes a free slot for an object at `row`; room must be reserved.
  [[nodiscard]] Key acquire(std::uint32_t row, ClientData data) noexcept;

  /// As above, for objects in consecutive rows from `row` on, one for each of `keys`. If `data` is
  /// empty, client data are 0.
  void acquire(std::uint32_t row, std::span<const ClientData> data, std::span<Key> keys,
               const Execution& execution) noexcept;

  /// Frees the slot of a valid key. A slot without further generations continues with another tag,
  /// or is retired if the process has no free tag.
  void release(ObjectId id) noexcept;

  /// Frees every slot: all keys become stale.
  void clear() noexcept;

  /// Frees the memory if no slot was ever used. Stamps of used slots are kept, because they detect
  /// stale keys.
  void release_if_unused() noexcept;

  [[nodiscard]] bool is_valid(Key key) const noexcept {
    return key.id < stamps_.size() && stamps_[key.id] == key.stamp && (key.stamp & 1U) != 0;
  }
  /// Results of `is_valid` for a sequence of keys.
  struct KeysCheck {
    bool valid = true;      ///< all keys are valid
    bool ascending = true;  ///< ids ascend strictly
  };
  [[nodiscard]] KeysCheck check_keys(std::span<const Key> keys) const noexcept;
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
  /// Prefetches the data that `key_of` and `client_data` read.
  void fetch(ObjectId id) const noexcept {
    __builtin_prefetch(stamps_.data() + id);
    __builtin_prefetch(data_.data() + id);
  }

  [[nodiscard]] std::size_t size() const noexcept { return live_; }
  /// Number of slots ever used; every ObjectId is below it.
  [[nodiscard]] std::size_t slot_count() const noexcept { return stamps_.size(); }
  /// Number of slots that fit in the allocated memory.
  [[nodiscard]] std::size_t capacity() const noexcept { return stamps_.capacity(); }

  // Access for snapshots.

  /// Stamps by slot; stamps of free slots are even.
  [[nodiscard]] std::span<const std::uint32_t> stamps() const noexcept {
    return {stamps_.data(), stamps_.size()};
  }
  [[nodiscard]] std::span<const ClientData> all_client_data() const noexcept {
    return {data_.data(), data_.size()};
  }
  /// Returns the stamp that precedes the first stamp of a new slot. It is even, and higher than
  /// every stamp with the same tag that a slot had before the latest restore.
  [[nodiscard]] std::uint32_t stamp() const noexcept { return stamp_; }
  /// The next free slot to be taken, and the free slot after `id`; kNoObject if there is none.
  [[nodiscard]] ObjectId first_free() const noexcept { return first_free_; }
  [[nodiscard]] ObjectId next_free(ObjectId id) const noexcept { return rows_[id]; }

  /// Slots in the form of a snapshot.
  struct SavedSlots {
    std::span<const std::uint32_t> stamps;
    std::span<const ClientData> data;
    std::span<const ObjectId> free;  ///< in the order in which they will be taken
    std::uint32_t stamp = 0;
  };
  /// Returns true if the saved slots are consistent: free slots have even stamps and are listed
  /// once each. `seen` is scratch with one byte per slot.
  [[nodiscard]] static bool are_consistent(const SavedSlots& saved,
                                           Column<std::uint8_t>& seen) noexcept;
  /// Reserves room for `slots` slots. Returns false, and changes nothing, if memory is refused.
  [[nodiscard]] bool reserve_slots(std::size_t slots) noexcept {
    return stamps_.grow(slots) && rows_.grow(slots) && data_.grow(slots);
  }
  /// Becomes the saved table, with objects in rows by ascending id; room must be reserved.
  /// Exchanges tags with `other`, which may be this table. The keys are the saved ones unless a
  /// third table has their tags. Later keys differ from the saved ones and from all keys that
  /// either table returned.
  void restore(const SavedSlots& saved, KeyTable& other) noexcept;

  [[nodiscard]] std::pmr::memory_resource* key_memory() const noexcept { return rows_.memory(); }
  [[nodiscard]] Bytes key_bytes() const noexcept;
  [[nodiscard]] Bytes client_data_bytes() const noexcept { return data_.bytes(); }

 private:
  [[nodiscard]] bool are_valid(std::span<const Key> keys) const noexcept;
  [[nodiscard]] bool are_valid_ascending(std::span<const Key> keys) const noexcept;

  /// Returns a stamp that slots may begin with after a restore; see `stamp()`.
  [[nodiscard]] std::uint32_t stamp_beyond(const SavedSlots& saved) noexcept;
  /// Returns by how many generations `stamp` comes after `stamp_`; more than `most_uses()` if it
  /// has another tag or comes before.
  [[nodiscard]] std::uint32_t uses_before(std::uint32_t stamp) const noexcept {
    return stamp - stamp_;
  }
  /// Returns the number of generations after `stamp_` under its tag.
  [[nodiscard]] std::uint32_t most_uses() const noexcept {
    return (stamp_ | kGenerationMask) - stamp_;
  }

  static constexpr unsigned kGenerationBits = 32 - PartitionTagPool::kBits;
  static constexpr std::uint32_t kGenerationMask = (1U << kGenerationBits) - 1;

  Column<std::uint32_t> stamps_;
  Column<std::uint32_t> rows_;
  Column<ClientData> data_;
  std::size_t live_ = 0;
  std::size_t free_count_ = 0;
  ObjectId first_free_ = kNoObject;
  PartitionTagPool tags_;
  std::uint32_t stamp_;  // under a tag of this table, see `stamp`
};

}  // namespace winnow
