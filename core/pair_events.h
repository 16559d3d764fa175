#pragma once

#include <winnow/core/column.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/pair_buffer.h>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <utility>

namespace winnow {

/// Two objects by key, first.id < second.id. Keys, because an object that ended its pair may be
/// gone, and its id another object's.
struct KeyPair {
  Key first;   ///< with the smaller id
  Key second;  ///< with the larger id

  /// The same two objects.
  friend constexpr bool operator==(const KeyPair&, const KeyPair&) noexcept = default;
};

/// The client data of two objects.
struct ClientDataPair {
  ClientData first = 0;   ///< that the one with the smaller id was inserted with
  ClientData second = 0;  ///< that the one with the larger id was inserted with

  /// The same data.
  friend constexpr bool operator==(const ClientDataPair&, const ClientDataPair&) noexcept = default;
};

/// How PairEvents are kept.
struct PairEventsOptions {
  /// Every allocation comes from here. It must outlive them.
  std::pmr::memory_resource* memory = default_memory();
  /// Give client data with the pairs. Takes 8 bytes an object and 16 a pair that begins or ends; a
  /// frame then costs O(pairs that begin or end + objects that moved) more.
  bool client_data = false;
};

/// What changed between two frames: handed to `Partition::self_pairs` with the PairBuffer that
/// holds the earlier frame's pairs. With another buffer, or one that was used otherwise in between,
/// it starts anew: every pair begins and none ends. A refused call reports nothing and forgets
/// nothing: the buffer holds the earlier frame's pairs, in any order, and the next call reports
/// what changed since then. A caller who wants only the changes passes no buffer: the events then
/// keep the pairs themselves.
class WINNOW_API PairEvents {
 public:
  /// Nothing has happened yet.
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
  /// The same without client data. Every allocation comes from `memory`, which must outlive it.
  explicit PairEvents(std::pmr::memory_resource* memory = default_memory()) noexcept
      : PairEvents(PairEventsOptions{memory, false}) {}
  /// `other` is left empty and starts anew, with client data if it had them.
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

  /// Pairs that are in this frame and were not in the last, sorted by ids.
  [[nodiscard]] std::span<const KeyPair> begun() const noexcept {
    return {begun_.data(), begun_.size()};
  }
  /// Pairs that were in the last frame and are not in this one, sorted by ids. A removed object's
  /// key is stale.
  [[nodiscard]] std::span<const KeyPair> ended() const noexcept {
    return {ended_.data(), ended_.size()};
  }
  /// Client data of the pairs in `begun()`, in its order; none unless they were asked for, see
  /// PairEventsOptions.
  [[nodiscard]] std::span<const ClientDataPair> begun_data() const noexcept {
    return {begun_data_.data(), begun_data_.size()};
  }
  /// Client data of the pairs in `ended()`, in its order, of removed objects as of others, whoever
  /// has their ids now; none unless they were asked for.
  [[nodiscard]] std::span<const ClientDataPair> ended_data() const noexcept {
    return {ended_data_.data(), ended_data_.size()};
  }
  /// How many pairs are in both: the first ones of the PairBuffer; those that began follow, in the
  /// order in which they are told.
  [[nodiscard]] std::size_t persisting() const noexcept { return persisting_; }

  /// Forgets what there was: the next query starts anew, and every pair begins. Memory is kept.
  void clear() noexcept {
    begun_.clear();
    ended_.clear();
    begun_data_.clear();
    ended_data_.clear();
    persisting_ = 0;
    pairs_.clear();
    provenance_ = {};
  }

  /// Bytes of begun and ended pairs and of their client data under `results`, the rest under
  /// `scratch`.
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
  Column<std::uint64_t> spare_;   // what pairs are sorted through
  Column<std::uint32_t> stamps_;  // by id, as of the last frame
  Column<ClientData> data_;       // by id, as of the last frame, if client data are asked for
  PairBuffer pairs_;              // of a caller who has no buffer
  std::size_t persisting_ = 0;
  bool with_client_data_;
  bool after_is_all_ = false;  // after_ holds every pair of the last frame
  PairBuffer::Provenance provenance_;
};

}  // namespace winnow
