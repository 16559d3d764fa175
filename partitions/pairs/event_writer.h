#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/results.h>
#include "core/memory/key_table.h"
#include "partitions/pairs/pair_tracker.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Finds the pairs that begin and end in one query. Call order: a `hold` function before the buffer
/// changes, then `compare` or `store_changes`, which compare the new pairs with the old ones, then
/// `finish_frame`. Pairs are compared by keys: the stamps of the last frame show whether an id
/// belongs to the same object. The stamps change only in `finish_frame`, which cannot fail. If a
/// query fails for lack of memory, `undo` restores the last frame, and the next query compares with
/// that frame again. Functions that return bool return false if memory is refused, unless stated
/// otherwise.
class EventWriter {
 public:
  /// `out` is the buffer before the query.
  EventWriter(PairEvents& events, const KeyTable& keys, const PairBuffer& out,
              std::uint64_t partition, const Execution& execution) noexcept
      : events_(events), keys_(keys), execution_(execution) {
    const PairBuffer::Provenance mine = events.provenance_;
    follows_ =
        mine.serial != 0 && mine.partition == partition && mine == PairTracker::provenance(out);
    events_.before_.clear();
  }

  /// For a query in which any pair may end: stores all pairs of the last frame.
  [[nodiscard]] bool hold_all(const PairBuffer& out) noexcept;
  /// For a query in which pairs of moved objects may end: drops these pairs from the buffer, and
  /// stores them.
  [[nodiscard]] bool hold_moved(PairBuffer& out, const std::uint64_t* moved) noexcept;
  /// For a query in which no pair ends, or ended pairs stay in the buffer until nothing can fail
  /// any more.
  void hold_none(const PairBuffer& out) noexcept {
    kept_ = follows_ ? out.size() : 0;
    held_ = HeldPairs::kept;
  }

  /// Fills the events and orders the buffer: persisting pairs first, then begun ones. `moved` are
  /// the objects that changed since the last frame; ignored if `all` is true, which means that any
  /// object may have changed. O(dropped or found pairs + moved).
  [[nodiscard]] bool compare(PairBuffer& out, std::span<const ObjectId> moved, bool all) noexcept;

  /// As above for a linked buffer, which passes its changes: the begun pairs, which are the last
  /// ones of `out`, and the indices of the ended pairs. O(begun + ended + moved).
  [[nodiscard]] bool store_changes(const PairBuffer& out, std::span<const Pair> begun,
                                   std::span<const std::uint32_t> ended,
                                   std::span<const ObjectId> moved) noexcept;
  /// Stores whether any id of `moved` belongs to another object than in the last frame.
  void find_reused(std::span<const ObjectId> moved) noexcept {
    other_keys_ = any_other_key(moved, false);
  }
  /// True if the id, live in the last frame, now belongs to another object. Call after
  /// `find_reused`.
  [[nodiscard]] bool is_reused(ObjectId id) const noexcept { return other_keys_ && is_other(id); }

  /// Reserves memory for frames of up to `pairs` pairs and `objects` objects.
  [[nodiscard]] static bool reserve(PairEvents& events, std::size_t pairs, std::size_t objects,
                                    Pages pages) noexcept;

  /// True if the events describe the frame whose pairs the buffer contains.
  [[nodiscard]] bool follows() const noexcept { return follows_; }
  /// Returns the buffer that events use if the caller has none.
  [[nodiscard]] static PairBuffer& own_buffer(PairEvents& events) noexcept { return events.pairs_; }
  /// Returns the frame that the events describe.
  [[nodiscard]] static PairBuffer::Provenance provenance(const PairEvents& events) noexcept {
    return events.provenance_;
  }
  [[nodiscard]] std::size_t persisting() const noexcept { return events_.persisting_; }

  /// Ends a query: the events describe this frame, and the stamps of its ids are stored.
  void finish_frame(PairBuffer::Provenance provenance) noexcept;
  /// Restores the pairs of the last frame in the buffer, in any order, and gives that frame a new
  /// provenance; no pair begins or ends. False if the events do not describe that frame: the caller
  /// then empties the buffer.
  [[nodiscard]] bool undo(PairBuffer& out, PairBuffer::Provenance provenance) noexcept;

 private:
  /// Location of the pairs of the last frame. `kept`: the first `kept_` pairs of the buffer.
  /// `dropped`: these pairs and dropped_. `all`: before_.
  enum class HeldPairs : std::uint8_t { nothing, kept, dropped, all };

  [[nodiscard]] bool sort_into(Column<std::uint64_t>& list, std::span<const Pair> pairs) noexcept;
  [[nodiscard]] bool merge(Pair*& to) noexcept;
  [[nodiscard]] bool write_client_data() noexcept;
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
  bool other_keys_ = false;  // an id belongs to another object than in the last frame
  bool follows_ = false;     // the events describe the frame of the buffer
  std::size_t kept_ = 0;     // pairs at the front of the buffer that persist
  HeldPairs held_ = HeldPairs::nothing;
  std::span<const ObjectId> moved_;  // ids whose stamps finish_frame stores
  bool all_ = false;                 // store the stamps of all ids
};

}  // namespace winnow
