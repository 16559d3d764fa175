#pragma once

#include <winnow/core/status.h>
#include "core/memory/byte_stream.h"

#include <algorithm>

namespace winnow {

/// Writes the slots of a table to a snapshot: their number, and the free slots in the order in
/// which they became free. The last slot of this list is taken first.
inline void write_slots(ByteWriter& out, std::size_t places, const Column<std::uint32_t>& free) {
  out.put(std::uint64_t{places});
  out.put_array(std::span<const std::uint32_t>(free.data(), free.size()));
}

/// The slots of a table that is read from a snapshot.
class SlotReader {
 public:
  explicit SlotReader(std::pmr::memory_resource* memory) noexcept : free_(memory), taken_(memory) {}

  /// Reads slots; the entries that follow must take at least one byte each. Returns false on
  /// failure.
  [[nodiscard]] bool read(ByteReader& in) noexcept {
    const auto count = in.get<std::uint64_t>();
    if (!in.get_array(free_)) return false;
    const bool fits = count >= free_.size() && count - free_.size() <= in.rest().size();
    if (!fits) return in.fail();
    places_ = static_cast<std::size_t>(count);
    if (!taken_.resize(places_)) return in.refuse_memory();
    std::fill(taken_.begin(), taken_.end(), std::uint8_t{1});
    for (const std::uint32_t place : free_) {
      if (place >= places_ || taken_[place] == 0) return in.fail();
      taken_[place] = 0;
    }
    return true;
  }
  /// Makes all slots of a table free, and orders the free list so that entries get their saved
  /// slots if they are added in ascending order of these slots. Afterwards the free list is the
  /// saved one. Returns false if memory is refused.
  template <typename Entry>
  [[nodiscard]] bool open(ByteReader& in, Column<Entry>& entries, Column<std::uint32_t>& free,
                          const Entry& nothing) noexcept {
    // Entries are resized last, so that a refusal leaves none uninitialised.
    if (!free.resize(places_) || !entries.resize(places_)) return in.refuse_memory();
    std::fill(entries.begin(), entries.end(), nothing);
    std::uint32_t* at = std::copy(free_.begin(), free_.end(), free.begin());
    for (std::size_t place = places_; place-- > 0;) {
      if (taken_[place] != 0) *at++ = static_cast<std::uint32_t>(place);
    }
    return true;
  }
  [[nodiscard]] std::size_t size() const noexcept { return places_; }
  [[nodiscard]] std::size_t taken() const noexcept { return places_ - free_.size(); }

 private:
  Column<std::uint32_t> free_;
  Column<std::uint8_t> taken_;
  std::size_t places_ = 0;
};

/// Returns ok and out_of_memory as they are, and invalid_argument for any other error: the bytes
/// are not a valid snapshot.
[[nodiscard]] inline Status snapshot_status(Status status) noexcept {
  return status == Status::ok || status == Status::out_of_memory ? status
                                                                 : Status::invalid_argument;
}

}  // namespace winnow
