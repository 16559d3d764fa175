#pragma once

#include <winnow/core/results.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Updates a PairBuffer in place. The cost depends on the moved objects and their pairs; there is
/// no pass over all pairs or all objects.
///
/// Each pair is in two doubly linked lists, one for each of its objects. A list element is encoded
/// as 2 * index of the pair, + 1 in the list of the second object. Removing a pair is O(1) even for
/// an object with many pairs.
///
/// Linking all pairs at once would cost as much as several frames. Links are therefore made for a
/// part of the pairs in each frame, from the front; pairs without links are scanned.
///
/// An update compares the pairs that were found for moved objects with the pairs in their lists.
/// Pairs in both stay in place. An ended pair is replaced by the last pair of the buffer, in
/// descending order of index. Begun pairs are appended, sorted. The order of pairs thus depends on
/// earlier frames but not on the order in which pairs were found: it is the same for any number of
/// threads and any instruction set.
class LinkedPairs {
 public:
  explicit LinkedPairs(PairBuffer& out) noexcept : out_(out) {}

  /// Forbids linking, for buffers whose pairs are all read in every frame anyway.
  void forbid_linking() noexcept { out_.may_link_ = false; }
  /// True if a frame with `moved` moved objects should be updated in place: few moved, and either
  /// few moved in the last frame or the buffer is linked already.
  [[nodiscard]] bool is_due(std::size_t moved, std::size_t objects) const noexcept;
  [[nodiscard]] static bool is_linked(const PairBuffer& out) noexcept {
    return out.state_ == PairBuffer::LinkState::linked;
  }
  /// False if linking is forbidden, or there are more pairs than a link can encode.
  [[nodiscard]] bool can_link() const noexcept {
    return out_.may_link_ && out_.size() <= kNoPlace / 4;
  }
  /// Starts linking if the buffer is not linked, and makes room for objects below `slots`. False if
  /// memory is refused.
  [[nodiscard]] bool link(std::size_t slots) noexcept;
  /// Links all remaining pairs of a linked buffer.
  void link_rest() noexcept { link_next(out_.size()); }
  /// Marks the buffer as not linked, before a frame with `moved` moved objects finds pairs without
  /// this class. If few objects moved, the next frame with few moved objects may be in place.
  void unlink_pairs(std::size_t moved, std::size_t objects) noexcept;
  /// Marks the buffer as not linked, for a frame that finds all pairs again.
  void unlink_pairs() noexcept { out_.state_ = PairBuffer::LinkState::unlinked; }

  /// Compares the old and new pairs of the moved objects, which are given as a list and as a bitmap
  /// (`is_moved`). The pairs from `kept` on were found in this frame; only begun ones stay there.
  /// Collects the indices of the pairs before `kept` that ended. If reused(id) is true, the id
  /// belongs to another object now; its old pairs end and its new pairs begin. False if memory is
  /// refused.
  template <typename Reused>
  [[nodiscard]] bool compare(std::size_t kept, std::span<const std::uint32_t> moved,
                             const std::uint64_t* is_moved, Reused&& reused) noexcept;
  /// Adds a begun or ended pair of objects that did not move. All pairs must be linked.
  [[nodiscard]] bool begin(const Pair& pair) noexcept { return out_.rows_.push_back(pair); }
  [[nodiscard]] bool end(const Pair& pair) noexcept;
  /// Sorts begun and ended pairs and reserves their links. False if memory is refused.
  [[nodiscard]] bool sort() noexcept;

  /// Returns the begun pairs, sorted.
  [[nodiscard]] std::span<const Pair> begun() const noexcept { return out_.pairs().subspan(kept_); }
  /// Returns the indices of the ended pairs, descending.
  [[nodiscard]] std::span<const std::uint32_t> ended() const noexcept {
    return {out_.places_.data(), out_.places_.size()};
  }
  /// Removes ended pairs and links begun ones. Until then the pairs of the last frame stay in
  /// place.
  void apply() noexcept;

 private:
  static constexpr std::uint32_t kNoPlace = 0xFFFFFFFFU;

  [[nodiscard]] bool is_worthwhile(std::size_t moved, std::size_t objects) const noexcept;
  [[nodiscard]] bool grow_heads(std::size_t slots) noexcept;
  [[nodiscard]] static ObjectId object_at(const Pair& pair, std::uint32_t side) noexcept {
    return side == 0 ? pair.first : pair.second;
  }
  void link_next(std::size_t count) noexcept;
  void insert_links(std::uint32_t index) noexcept;
  void remove_links(std::uint32_t index) noexcept;
  void replace(std::uint32_t index, std::uint32_t last) noexcept;
  void move(std::uint32_t from, std::uint32_t to) noexcept;
  [[nodiscard]] bool hash_found() noexcept;
  [[nodiscard]] bool mark_found(const Pair& pair) noexcept;
  void append_begun() noexcept;

  PairBuffer& out_;
  std::size_t kept_ = 0;
};

template <typename Reused>
bool LinkedPairs::compare(std::size_t kept, std::span<const std::uint32_t> moved,
                          const std::uint64_t* is_moved, Reused&& reused) noexcept {
  kept_ = kept;
  out_.places_.clear();
  if (!hash_found()) return false;
  const auto has_moved = [&](ObjectId id) { return (is_moved[id >> 6U] >> (id & 63U) & 1U) != 0; };
  const auto compare_pair = [&](std::uint32_t index) {
    const Pair pair = out_.rows_[index];
    const bool persists = !reused(pair.first) && !reused(pair.second) && mark_found(pair);
    return persists || out_.places_.push_back(index);
  };
  for (const ObjectId id : moved) {
    if (id >= out_.heads_.size()) continue;
    for (std::uint32_t place = out_.heads_[id]; place != kNoPlace;) {
      const std::uint32_t index = place >> 1U;
      const std::uint32_t side = place & 1U;
      // If both objects moved, the pair is compared from the smaller id.
      const ObjectId other = object_at(out_.rows_[index], side ^ 1U);
      if (!(other < id && has_moved(other)) && !compare_pair(index)) return false;
      place = out_.links_[index].next[side];
    }
  }
  for (std::size_t i = out_.links_.size(); i < kept; ++i) {
    const Pair& pair = out_.rows_[i];
    if ((has_moved(pair.first) || has_moved(pair.second)) &&
        !compare_pair(static_cast<std::uint32_t>(i))) {
      return false;
    }
  }
  append_begun();
  return true;
}

}  // namespace winnow
