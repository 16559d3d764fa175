#pragma once

#include <winnow/core/column.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
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

/// What changed between two frames: handed to `Partition::self_pairs` with the PairBuffer that
/// holds the earlier frame's pairs. With another buffer, or one that was used otherwise in between,
/// it starts anew: every pair begins and none ends. A caller who wants changes alone hands over no
/// buffer: the events then keep the pairs themselves.
class WINNOW_API PairEvents {
 public:
  /// Nothing has happened yet. Every allocation comes from `memory`, which must outlive it.
  explicit PairEvents(std::pmr::memory_resource* memory = std::pmr::get_default_resource()) noexcept
      : begun_(memory),
        ended_(memory),
        dropped_(memory),
        before_(memory),
        after_(memory),
        spare_(memory),
        stamps_(memory),
        pairs_(memory) {}
  /// `other` is left empty and starts anew.
  PairEvents(PairEvents&& other) noexcept
      : begun_(std::move(other.begun_)),
        ended_(std::move(other.ended_)),
        dropped_(std::move(other.dropped_)),
        before_(std::move(other.before_)),
        after_(std::move(other.after_)),
        spare_(std::move(other.spare_)),
        stamps_(std::move(other.stamps_)),
        pairs_(std::move(other.pairs_)),
        persisting_(std::exchange(other.persisting_, 0)),
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
  /// How many pairs are in both: the first ones of the PairBuffer; those that began follow, in the
  /// order in which they are told.
  [[nodiscard]] std::size_t persisting() const noexcept { return persisting_; }

  /// Forgets what there was: the next query starts anew, and every pair begins. Memory is kept.
  void clear() noexcept {
    begun_.clear();
    ended_.clear();
    persisting_ = 0;
    pairs_.clear();
    provenance_ = {};
  }

  /// Bytes of begun and ended pairs under `results`, the rest under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class EventWriter;

  Column<KeyPair> begun_;
  Column<KeyPair> ended_;
  Column<Pair> dropped_;
  Column<std::uint64_t> before_;  // pairs that may have ended, as (first << 32 | second)
  Column<std::uint64_t> after_;   // pairs that may have begun
  Column<std::uint64_t> spare_;   // what pairs are sorted through
  Column<std::uint32_t> stamps_;  // by id, as of the last frame
  PairBuffer pairs_;              // of a caller who has no buffer
  std::size_t persisting_ = 0;
  bool after_is_all_ = false;  // after_ holds every pair of the last frame
  PairBuffer::Provenance provenance_;
};

}  // namespace winnow
