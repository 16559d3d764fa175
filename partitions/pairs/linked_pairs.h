#pragma once

#include <winnow/core/pair_buffer.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Keeps a PairBuffer up to date at a cost that follows what moved and how many pairs that has: no
/// pass over all pairs, nor over all objects.
///
/// Every pair stands in two lists, that of its first and that of its second object. A place in a
/// list is twice the pair's index in the buffer, plus one in the list of the second object. Lists
/// lead both ways, so that a pair leaves in O(1) even that of an object with many pairs.
///
/// To link all pairs at once would be a frame that costs several others. So links are made for some
/// of them in each frame, from the front; the rest is looked through until it has its own.
///
/// An update is told what was found anew about the objects that moved, and compares that with what
/// their lists hold. Pairs that are in both stay where they are. A pair that ended is replaced by
/// the last one of the buffer, those at the back going first; pairs that began follow the others,
/// sorted. So the order of pairs depends on what happened, but on no order in which anything was
/// found: it is the same on any number of threads and any instruction set.
class LinkedPairs {
 public:
  explicit LinkedPairs(PairBuffer& out) noexcept : out_(out) {}

  /// The buffer is never linked: for who looks at all pairs in every frame whatever moved.
  void forbid() noexcept { out_.may_link_ = false; }
  /// True if a frame in which so many of the objects moved is to update the buffer here: where few
  /// do, the second of two frames in a row begins to link it.
  [[nodiscard]] bool is_due(std::size_t moved, std::size_t objects) const noexcept;
  [[nodiscard]] static bool is_linked(const PairBuffer& out) noexcept {
    return out.state_ == PairBuffer::State::linked;
  }
  /// False where that is forbidden, and for more pairs than links can name.
  [[nodiscard]] bool can_link() const noexcept {
    return out_.may_link_ && out_.size() <= kNoPlace / 4;
  }
  /// Begins to link the buffer unless that has begun, with room for objects below `slots`. False if
  /// memory is refused.
  [[nodiscard]] bool link(std::size_t slots) noexcept;
  /// Links all that is left, once that has begun.
  void link_rest() noexcept { link_next(out_.size()); }
  /// In this frame, in which so many of the objects moved, the pairs are changed by other means.
  void loosen(std::size_t moved, std::size_t objects) noexcept;
  /// All pairs were found anew.
  void loosen() noexcept { out_.state_ = PairBuffer::State::loose; }

  /// Of pairs in the buffer from `kept` on, found anew about the objects that moved (a bit each in
  /// `is_moved`), keeps those that began, and finds which of the others ended. Where renewed(id)
  /// says that an id went to another object, its pairs end and begin. False if memory is refused.
  template <typename Renewed>
  [[nodiscard]] bool compare(std::size_t kept, std::span<const std::uint32_t> moved,
                             const std::uint64_t* is_moved, Renewed&& renewed) noexcept;
  /// One more pair that began, or ended, of objects that did not move; all are linked.
  [[nodiscard]] bool begin(const Pair& pair) noexcept { return out_.pairs_.push_back(pair); }
  [[nodiscard]] bool end(const Pair& pair) noexcept;
  /// Brings what began and ended in order, and makes room for their links. False if memory is
  /// refused.
  [[nodiscard]] bool sort() noexcept;

  /// Pairs that began, sorted.
  [[nodiscard]] std::span<const Pair> begun() const noexcept { return out_.pairs().subspan(kept_); }
  /// Indices in the buffer of pairs that ended, from the back to the front.
  [[nodiscard]] std::span<const std::uint32_t> ended() const noexcept {
    return {out_.places_.data(), out_.places_.size()};
  }
  /// Takes out what ended and links what began. Until then the pairs of the last frame stand where
  /// they stood.
  void apply() noexcept;

 private:
  static constexpr std::uint32_t kNoPlace = 0xFFFFFFFFU;

  [[nodiscard]] bool pays(std::size_t moved, std::size_t objects) const noexcept;
  [[nodiscard]] bool cover_objects(std::size_t slots) noexcept;
  [[nodiscard]] static ObjectId object_at(const Pair& pair, std::uint32_t side) noexcept {
    return side == 0 ? pair.first : pair.second;
  }
  void link_next(std::size_t count) noexcept;
  void enter(std::uint32_t index) noexcept;
  void leave(std::uint32_t index) noexcept;
  void replace(std::uint32_t index, std::uint32_t last) noexcept;
  void move(std::uint32_t from, std::uint32_t to) noexcept;
  [[nodiscard]] bool table_found() noexcept;
  [[nodiscard]] bool take_found(const Pair& pair) noexcept;
  void keep_begun() noexcept;

  PairBuffer& out_;
  std::size_t kept_ = 0;
};

template <typename Renewed>
bool LinkedPairs::compare(std::size_t kept, std::span<const std::uint32_t> moved,
                          const std::uint64_t* is_moved, Renewed&& renewed) noexcept {
  kept_ = kept;
  out_.places_.clear();
  if (!table_found()) return false;
  const auto has_moved = [&](ObjectId id) { return (is_moved[id >> 6U] >> (id & 63U) & 1U) != 0; };
  const auto compare_pair = [&](std::uint32_t index) {
    const Pair pair = out_.pairs_[index];
    const bool persists = !renewed(pair.first) && !renewed(pair.second) && take_found(pair);
    return persists || out_.places_.push_back(index);
  };
  for (const ObjectId id : moved) {
    if (id >= out_.heads_.size()) continue;
    for (std::uint32_t place = out_.heads_[id]; place != kNoPlace;) {
      const std::uint32_t index = place >> 1U;
      const std::uint32_t side = place & 1U;
      // Of two objects that both moved the one with the lesser id looks at their pair.
      const ObjectId other = object_at(out_.pairs_[index], side ^ 1U);
      if (!(other < id && has_moved(other)) && !compare_pair(index)) return false;
      place = out_.links_[index].next[side];
    }
  }
  for (std::size_t i = out_.links_.size(); i < kept; ++i) {
    const Pair& pair = out_.pairs_[i];
    if ((has_moved(pair.first) || has_moved(pair.second)) &&
        !compare_pair(static_cast<std::uint32_t>(i))) {
      return false;
    }
  }
  keep_begun();
  return true;
}

}  // namespace winnow
