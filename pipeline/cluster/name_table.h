#pragma once

#include "core/memory/scattered.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <vector>

namespace winnow {

/// True if a value occurs twice. Sorts a copy. O(n log n).
template <typename T>
[[nodiscard]] bool has_twice(std::vector<T> values) {
  std::sort(values.begin(), values.end());
  return std::adjacent_find(values.begin(), values.end()) != values.end();
}

/// Hash table from names of bodies to numbers below 2^32 - 1, with linear probing. Erasing leaves
/// no tombstones (Knuth, The Art of Computer Programming 3, 6.4, algorithm R). Throws
/// std::bad_alloc like the standard containers, and is then unchanged.
class NameTable {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  explicit NameTable(std::pmr::memory_resource* memory) : places_(memory) {}

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return places_.capacity() * sizeof(Slot); }

  /// Returns the number of a name; kNone if there is none.
  [[nodiscard]] std::uint32_t find(std::uint64_t name) const noexcept {
    return places_.empty() ? kNone : places_[place_of(name)].number;
  }

  /// Prefetches the entry that `find` reads first.
  void fetch(std::uint64_t name) const noexcept {
    if (!places_.empty()) __builtin_prefetch(&places_[first_slot_of(name)]);
  }

  /// Reserves memory for `count` names in total.
  void reserve(std::size_t count) {
    std::size_t places = places_.empty() ? 16 : places_.size();
    while (count * 4 > places * 3) places *= 2;
    if (places == places_.size()) return;
    std::pmr::vector<Slot> old(places, Slot{}, places_.get_allocator());
    old.swap(places_);
    for (const Slot& place : old) {
      if (place.number != kNone) places_[place_of(place.name)] = place;
    }
  }

  /// Sets the number of a name; adds the name if it is absent.
  void set(std::uint64_t name, std::uint32_t number) {
    reserve(size_ + 1);
    Slot& place = places_[place_of(name)];
    if (place.number == kNone) ++size_;
    place = {name, number};
  }

  /// Removes a name if it is present.
  void erase(std::uint64_t name) noexcept {
    if (find(name) == kNone) return;
    std::size_t gap = place_of(name);
    for (std::size_t i = next(gap); places_[i].number != kNone; i = next(i)) {
      // An entry can stay if its search starts after the gap.
      const std::size_t first_slot = first_slot_of(places_[i].name);
      if (((i - first_slot) & mask()) < ((i - gap) & mask())) continue;
      places_[gap] = places_[i];
      gap = i;
    }
    places_[gap] = {};
    --size_;
  }

 private:
  struct Slot {
    std::uint64_t name = 0;
    std::uint32_t number = kNone;
  };

  [[nodiscard]] std::size_t mask() const noexcept { return places_.size() - 1; }
  [[nodiscard]] std::size_t next(std::size_t i) const noexcept { return (i + 1) & mask(); }
  [[nodiscard]] std::size_t first_slot_of(std::uint64_t name) const noexcept {
    return scattered(name) & mask();
  }
  [[nodiscard]] std::size_t place_of(std::uint64_t name) const noexcept {
    std::size_t i = first_slot_of(name);
    while (places_[i].number != kNone && places_[i].name != name) i = next(i);
    return i;
  }

  std::pmr::vector<Slot> places_;
  std::size_t size_ = 0;
};

}  // namespace winnow
