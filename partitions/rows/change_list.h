#pragma once

#include <winnow/core/key.h>
#include <winnow/core/memory.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Set of object ids that changed: a bitmap, and a list in order of change. If more than a quarter
/// of all ids, plus 16, changed, it only records "all", because tracking single objects then costs
/// more than it saves.
class ChangeList {
 public:
  explicit ChangeList(std::pmr::memory_resource* memory) noexcept : bits_(memory), list_(memory) {}

  /// Makes room for ids below `slots`, so that `add` cannot fail.
  [[nodiscard]] bool reserve(std::size_t slots) noexcept;

  /// Prefaults reserved pages.
  void touch() noexcept;

  void add(ObjectId id) noexcept {
    std::uint64_t& word = bits_[id >> 6U];
    const std::uint64_t bit = std::uint64_t{1} << (id & 63U);
    if ((word & bit) != 0 || all_) return;
    if (list_.size() == limit_) {
      all_ = true;
      return;
    }
    word |= bit;
    list_[list_.size()] = id;
    list_.set_size(list_.size() + 1);
  }
  void add_all() noexcept { all_ = true; }

  /// Returns the largest number of ids in the list; with more, it records only "all".
  [[nodiscard]] std::size_t limit() const noexcept { return limit_; }
  [[nodiscard]] bool all() const noexcept { return all_; }
  [[nodiscard]] bool empty() const noexcept { return !all_ && list_.empty(); }
  /// Returns the changed ids; valid only if not `all`.
  [[nodiscard]] std::span<const ObjectId> ids() const noexcept {
    return {list_.data(), list_.size()};
  }
  [[nodiscard]] const std::uint64_t* bits() const noexcept { return bits_.data(); }

  void clear() noexcept;
  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  Column<std::uint64_t> bits_;
  Column<ObjectId> list_;
  std::size_t limit_ = 0;
  bool all_ = false;
};

/// The objects of a partition that changed.
struct RowChanges {
  explicit RowChanges(std::pmr::memory_resource* memory) noexcept : stale(memory), moved(memory) {}

  bool any = false;          ///< true from a change until `end_refresh`
  ChangeList stale;          ///< changed since the last refresh
  mutable ChangeList moved;  ///< changed since the pair tracker cleared it, if moves are tracked

  void add(ObjectId id) noexcept {
    stale.add(id);
    any = true;
  }
  void add_all() noexcept {
    stale.add_all();
    any = true;
  }
  /// Clears `stale`. If `track_moves` is true, adds its objects to `moved` first.
  void end_refresh(bool track_moves) noexcept;

  // These functions do the same for both lists.
  [[nodiscard]] bool reserve(std::size_t slots) noexcept {
    return stale.reserve(slots) && moved.reserve(slots);
  }
  void touch() noexcept {
    stale.touch();
    moved.touch();
  }
  void clear() noexcept {
    stale.clear();
    moved.clear();
  }
  void release() noexcept {
    stale.release();
    moved.release();
  }
  [[nodiscard]] Bytes bytes() const noexcept {
    Bytes sum = stale.bytes();
    sum += moved.bytes();
    return sum;
  }
};

}  // namespace winnow
