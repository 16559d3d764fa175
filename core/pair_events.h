#pragma once

#include <winnow/core/column.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/pair_buffer.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <utility>

namespace winnow {

/// Two objects by key, first.id < second.id. An object whose pair ended may be removed and its id
/// reused: hence keys instead of ids.
struct KeyPair {
  Key first;   ///< key with the smaller id
  Key second;  ///< key with the larger id

  /// True unless the keys are null.
  [[nodiscard]] explicit constexpr operator bool() const noexcept { return bool{first}; }
  /// True if both objects are equal.
  friend constexpr bool operator==(const KeyPair&, const KeyPair&) noexcept = default;
};

/// The client data of two objects.
struct ClientDataPair {
  ClientData first = 0;   ///< client data of the object with the smaller id
  ClientData second = 0;  ///< client data of the object with the larger id

  /// True if both values are equal.
  friend constexpr bool operator==(const ClientDataPair&, const ClientDataPair&) noexcept = default;
};

/// Options of PairEvents.
struct PairEventsOptions {
  /// Source of every allocation; must outlive the events.
  std::pmr::memory_resource* memory = default_memory();
  /// Also return the client data of pairs. It takes 8 bytes per object and 16 per pair that begins
  /// or ends, and O(pairs that begin or end + objects that moved) per frame.
  bool client_data = false;
};

/// Pairs that began or ended between two frames. Callers pass it to `Partition::self_pairs` with
/// the PairBuffer that contains the earlier frame's pairs. If the buffer is another one, or if
/// other calls have changed it since then, the events start anew: every pair begins and none ends.
/// A refused call reports no change and loses none: the buffer still contains the earlier frame's
/// pairs, in any order, and the next call reports the changes since then. Callers that need only
/// the changes pass no buffer: PairEvents then stores the pairs itself.
class WINNOW_API PairEvents {
 public:
  /// Creates events without any pair.
  explicit PairEvents(const PairEventsOptions& options) noexcept
      : begun_(options.memory),
        ended_(options.memory),
        begun_data_(options.memory),
        ended_data_(options.memory),
        dropped_(options.memory),
        before_(options.memory),
        after_(options.memory),
        spare_(options.memory),
        stamps_(options.memory),
        data_(options.memory),
        pairs_(options.memory),
        with_client_data_(options.client_data) {}
  /// As above, without client data. Every allocation comes from `memory`, which must outlive the
  /// events.
  explicit PairEvents(std::pmr::memory_resource* memory = default_memory()) noexcept
      : PairEvents(PairEventsOptions{memory, false}) {}
  /// Takes the content of `other`, which becomes empty: its next query starts anew, with the same
  /// `client_data` option.
  PairEvents(PairEvents&& other) noexcept
      : begun_(std::move(other.begun_)),
        ended_(std::move(other.ended_)),
        begun_data_(std::move(other.begun_data_)),
        ended_data_(std::move(other.ended_data_)),
        dropped_(std::move(other.dropped_)),
        before_(std::move(other.before_)),
        after_(std::move(other.after_)),
        spare_(std::move(other.spare_)),
        stamps_(std::move(other.stamps_)),
        data_(std::move(other.data_)),
        pairs_(std::move(other.pairs_)),
        persisting_(std::exchange(other.persisting_, 0)),
        with_client_data_(other.with_client_data_),
        after_is_all_(std::exchange(other.after_is_all_, false)),
        provenance_(std::exchange(other.provenance_, {})) {}

  /// Returns the pairs of this frame that were not in the previous one, sorted by ids.
  [[nodiscard]] std::span<const KeyPair> begun() const noexcept {
    return {begun_.data(), begun_.size()};
  }
  /// Returns the pairs of the previous frame that are not in this one, sorted by ids. The key of a
  /// removed object is stale.
  [[nodiscard]] std::span<const KeyPair> ended() const noexcept {
    return {ended_.data(), ended_.size()};
  }
  /// Returns the client data of the pairs in `begun()`, in the same order; empty without the
  /// `client_data` option.
  [[nodiscard]] std::span<const ClientDataPair> begun_data() const noexcept {
    return {begun_data_.data(), begun_data_.size()};
  }
  /// Returns the client data of the pairs in `ended()`, in the same order; empty without the
  /// `client_data` option. Data of a removed object are its own, even if its id was reused.
  [[nodiscard]] std::span<const ClientDataPair> ended_data() const noexcept {
    return {ended_data_.data(), ended_data_.size()};
  }
  /// Returns the number of pairs that are in both frames. They come first in the PairBuffer; the
  /// pairs that began follow, in the order of `begun()`.
  [[nodiscard]] std::size_t persisting() const noexcept { return persisting_; }

  /// Removes all events and pairs: the next query starts anew, and every pair begins. Memory is
  /// kept.
  void clear() noexcept {
    begun_.clear();
    ended_.clear();
    begun_data_.clear();
    ended_data_.clear();
    persisting_ = 0;
    pairs_.clear();
    provenance_ = {};
  }

  /// Returns the bytes of the events: begun and ended pairs and their client data as `results`, all
  /// others as `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class EventWriter;

  Column<KeyPair> begun_;
  Column<KeyPair> ended_;
  Column<ClientDataPair> begun_data_;
  Column<ClientDataPair> ended_data_;
  Column<Pair> dropped_;
  Column<std::uint64_t> before_;  // pairs that may have ended, as (first << 32 | second)
  Column<std::uint64_t> after_;   // pairs that may have begun
  Column<std::uint64_t> spare_;   // scratch of sorting
  Column<std::uint32_t> stamps_;  // by id, in the previous frame
  Column<ClientData> data_;       // by id, in the previous frame; empty without client data
  PairBuffer pairs_;              // used if the caller passes no buffer
  std::size_t persisting_ = 0;
  bool with_client_data_;
  bool after_is_all_ = false;  // after_ contains all pairs of the previous frame
  PairBuffer::Provenance provenance_;
};

}  // namespace winnow
