#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/pair_events.h>
#include "core/memory/key_table.h"
#include "partitions/pairs/pair_tracker.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Finds for one query which pairs begin and end. It is told what the buffer holds before it
/// changes (one of the `hold` functions) and compares that with what it holds afterwards. Pairs are
/// told apart by keys: the stamps of the last frame say whether an id is still the same object's.
/// These change last (`take_frame`), when nothing can fail any more: a query that was refused
/// memory is undone (`undo`), and the next one compares with the same frame. A function that
/// returns false was refused memory.
class EventWriter {
 public:
  /// `out` as it is before the query of a partition.
  EventWriter(PairEvents& events, const KeyTable& keys, const PairBuffer& out,
              std::uint64_t partition, const Execution& execution) noexcept
      : events_(events), keys_(keys), execution_(execution) {
    const PairBuffer::Provenance mine = events.provenance_;
    follows_ =
        mine.serial != 0 && mine.partition == partition && mine == PairTracker::provenance(out);
    events_.before_.clear();
  }

  /// All pairs may end.
  [[nodiscard]] bool hold_all(const PairBuffer& out) noexcept;
  /// Pairs of objects that moved may end; they are dropped from the buffer.
  [[nodiscard]] bool hold_moved(PairBuffer& out, const std::uint64_t* moved) noexcept;
  /// No pair ends, or those that do stay in their places until nothing can fail any more.
  void hold_none(const PairBuffer& out) noexcept {
    kept_ = follows_ ? out.size() : 0;
    held_ = Held::kept;
  }

  /// Fills the events and puts the pairs that persist first, those that began behind them.
  /// `moved` are the objects that changed since the last frame, unless `all` may have. O(pairs that
  /// were dropped or found anew + moved).
  [[nodiscard]] bool compare(PairBuffer& out, std::span<const ObjectId> moved, bool all) noexcept;

  /// The same for a linked buffer, whose changes are found otherwise: pairs that began, the last
  /// ones of `out`, and the indices of those that ended. O(both + moved).
  [[nodiscard]] bool tell(const PairBuffer& out, std::span<const Pair> begun,
                          std::span<const std::uint32_t> ended,
                          std::span<const ObjectId> moved) noexcept;
  /// Looks for ids among `moved` that went to another object since the last frame.
  void find_renewed(std::span<const ObjectId> moved) noexcept {
    other_keys_ = any_other_key(moved, false);
  }
  /// True if the id, which was a live object's in the last frame, is one of those.
  [[nodiscard]] bool is_renewed(ObjectId id) const noexcept { return other_keys_ && is_other(id); }

  /// Room for frames of up to so many pairs and objects. False if memory is refused.
  [[nodiscard]] static bool reserve(PairEvents& events, std::size_t pairs, std::size_t objects,
                                    Pages pages) noexcept;

  /// True if the events tell of the frame that the buffer holds.
  [[nodiscard]] bool follows() const noexcept { return follows_; }
  /// Where events keep their pairs for a caller who has no buffer.
  [[nodiscard]] static PairBuffer& own_buffer(PairEvents& events) noexcept { return events.pairs_; }
  /// Which frame the events tell of.
  [[nodiscard]] static PairBuffer::Provenance provenance(const PairEvents& events) noexcept {
    return events.provenance_;
  }
  [[nodiscard]] std::size_t persisting() const noexcept { return events_.persisting_; }

  /// Ends a query: the events tell of this frame, and know whose the ids are in it.
  void take_frame(PairBuffer::Provenance provenance) noexcept;
  /// Puts the pairs of the last frame back into the buffer, in any order, and gives that frame
  /// another name: none begin or end. False if the events do not tell of that frame; the caller
  /// empties the buffer then.
  [[nodiscard]] bool undo(PairBuffer& out, PairBuffer::Provenance provenance) noexcept;

 private:
  /// Which pairs of the last frame are not in the buffer but elsewhere: none, those from `kept_` on
  /// in `dropped_`, or all in `before_`.
  enum class Held : std::uint8_t { nothing, kept, dropped, all };

  [[nodiscard]] bool sort_into(Column<std::uint64_t>& list, std::span<const Pair> pairs) noexcept;
  [[nodiscard]] bool merge(Pair*& to) noexcept;
  [[nodiscard]] bool give_client_data() noexcept;
  [[nodiscard]] bool reserve_frame(std::span<const ObjectId> moved, bool all) noexcept;
  [[nodiscard]] bool any_other_key(std::span<const ObjectId> moved, bool all) const noexcept;
  [[nodiscard]] bool is_other(ObjectId id) const noexcept {
    return events_.stamps_[id] != keys_.key_of(id).stamp;
  }
  [[nodiscard]] Key key_before(ObjectId id) const noexcept { return {id, events_.stamps_[id]}; }
  [[nodiscard]] bool end(std::uint64_t pair) noexcept;
  [[nodiscard]] bool begin(std::uint64_t pair) noexcept;

  PairEvents& events_;
  const KeyTable& keys_;
  const Execution& execution_;
  bool other_keys_ = false;  // an id went to another object since the last frame
  bool follows_ = false;     // the events tell of the frame that the buffer holds
  std::size_t kept_ = 0;     // pairs at the front of the buffer that persist for sure
  Held held_ = Held::nothing;
  std::span<const ObjectId> moved_;  // of which take_frame has something to remember, or
  bool all_ = false;                 // of all
};

}  // namespace winnow
