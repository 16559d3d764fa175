#pragma once

#include <winnow/core/column.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <utility>

namespace winnow {

/// Two objects that may touch. From `self_pairs`: first < second. From `pairs_with`: first belongs
/// to the partition that was asked, second to the other one.
struct Pair {
  ObjectId first = kNoObject;
  ObjectId second = kNoObject;

  friend constexpr auto operator<=>(const Pair&, const Pair&) noexcept = default;
};

/// The caller's array of pairs, reused from frame to frame. Handed to the same partition again it
/// carries last frame's pairs along: where few objects moved, only their pairs are redone. Any
/// other use (another partition, `clear`, `edit`) makes the next query a full one; the result is
/// the same set either way. Not for use from two threads at once.
class WINNOW_API PairBuffer {
 public:
  /// Which complete query the content came from; 0 is none.
  struct Provenance {
    std::uint64_t partition = 0;
    std::uint64_t serial = 0;
    friend constexpr bool operator==(const Provenance&, const Provenance&) noexcept = default;
  };

  explicit PairBuffer(std::pmr::memory_resource* memory = std::pmr::get_default_resource()) noexcept
      : pairs_(memory), pages_(memory), page_table_(memory) {}
  /// `other` is left empty: its next query is a full one.
  PairBuffer(PairBuffer&& other) noexcept
      : pairs_(std::move(other.pairs_)),
        pages_(std::move(other.pages_)),
        page_table_(std::move(other.page_table_)),
        provenance_(std::exchange(other.provenance_, {})) {}

  [[nodiscard]] std::span<const Pair> pairs() const noexcept { return {pairs_.data(), size()}; }
  [[nodiscard]] std::size_t size() const noexcept { return pairs_.size(); }
  [[nodiscard]] bool empty() const noexcept { return pairs_.empty(); }
  [[nodiscard]] const Pair& operator[](std::size_t i) const noexcept { return pairs_[i]; }
  [[nodiscard]] const Pair* begin() const noexcept { return pairs_.begin(); }
  [[nodiscard]] const Pair* end() const noexcept { return pairs_.end(); }

  /// Room for `count` pairs. False if memory is refused.
  [[nodiscard]] bool reserve(std::size_t count) noexcept { return pairs_.reserve(count); }

  void clear() noexcept {
    pairs_.clear();
    provenance_ = {};
  }

  /// The pairs, to be changed at will.
  [[nodiscard]] Column<Pair>& edit() noexcept {
    provenance_ = {};
    return pairs_;
  }

  /// Bytes under `results`; pages that parallel tasks wrote to under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class PairWriter;
  friend class PairTracker;

  Column<Pair> pairs_;
  // What tasks write before their output is put in order; see PairWriter.
  Column<Pair> pages_;
  Column<std::uint64_t> page_table_;
  Provenance provenance_;
};

}  // namespace winnow
