#pragma once

#include "core/memory/byte_stream.h"
#include "core/memory/key_table.h"

namespace winnow {

/// Writes keys to a snapshot: stamp of new slots, stamps and client data by id, and free ids in the
/// order in which they will be taken.
inline void put_keys(ByteWriter& out, const KeyTable& keys) noexcept {
  out.put(keys.stamp());
  out.put_array(keys.stamps());
  out.put_array(keys.all_client_data());
  std::uint64_t free = 0;
  for (ObjectId id = keys.first_free(); id != kNoObject; id = keys.next_free(id)) ++free;
  out.put(free);
  for (ObjectId id = keys.first_free(); id != kNoObject; id = keys.next_free(id)) out.put(id);
}

/// Calls visit(id) for the ids of live objects, ascending.
template <typename Visit>
void for_live(std::span<const std::uint32_t> stamps, const Visit& visit) {
  for (std::size_t slot = 0; slot < stamps.size(); ++slot) {
    if ((stamps[slot] & 1U) != 0) visit(static_cast<ObjectId>(slot));
  }
}

/// Keys read from a snapshot; KeyTable::are_consistent tests if they are consistent.
struct ReadKeys {
  explicit ReadKeys(std::pmr::memory_resource* memory) noexcept
      : stamps(memory), data(memory), free(memory) {}

  void read(ByteReader& in) noexcept {
    stamp = in.get<std::uint32_t>();
    (void)in.get_array(stamps);
    (void)in.get_array(data);
    (void)in.get_array(free);
  }
  [[nodiscard]] std::span<const std::uint32_t> all_stamps() const noexcept {
    return {stamps.data(), stamps.size()};
  }
  [[nodiscard]] KeyTable::SavedSlots saved() const noexcept {
    return {all_stamps(), {data.data(), data.size()}, {free.data(), free.size()}, stamp};
  }

  Column<std::uint32_t> stamps;
  Column<ClientData> data;
  Column<ObjectId> free;
  std::uint32_t stamp = 0;
};

}  // namespace winnow
