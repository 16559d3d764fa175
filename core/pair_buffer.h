#pragma once

#include <winnow/core/column.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
#include <winnow/core/large_pages.h>

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
  ObjectId first = kNoObject;   ///< an id of the partition that was asked
  ObjectId second = kNoObject;  ///< an id of it, or of the other one

  /// By the first object, then by the second.
  friend constexpr auto operator<=>(const Pair&, const Pair&) noexcept = default;
};

/// The caller's array of pairs, reused from frame to frame. Handed to the same partition again it
/// carries last frame's pairs along: where few objects moved, only their pairs are redone. Where
/// very few did in two frames one after the other, the buffer is linked, for 16 bytes a pair and 4
/// an object of its memory: an object then leads to its pairs, and a frame no longer looks at any
/// others. Any other use (another partition, `clear`, `edit`) makes the next query a full one; the
/// result is the same set either way. Not for use from two threads at once.
class WINNOW_API PairBuffer {
 public:
  /// Which complete query the content came from; 0 is none.
  struct Provenance {
    std::uint64_t partition = 0;  ///< a number that no other partition of the process has
    std::uint64_t serial = 0;     ///< grows with each query
    /// The same query.
    friend constexpr bool operator==(const Provenance&, const Provenance&) noexcept = default;
  };

  /// An empty buffer. Every allocation comes from `memory`, which must outlive it.
  explicit PairBuffer(std::pmr::memory_resource* memory = default_memory()) noexcept
      : pairs_(memory),
        pages_(memory),
        page_table_(memory),
        links_(memory),
        heads_(memory),
        places_(memory) {}
  /// `other` is left empty: its next query is a full one.
  PairBuffer(PairBuffer&& other) noexcept
      : pairs_(std::move(other.pairs_)),
        pages_(std::move(other.pages_)),
        page_table_(std::move(other.page_table_)),
        links_(std::move(other.links_)),
        heads_(std::move(other.heads_)),
        places_(std::move(other.places_)),
        state_(std::exchange(other.state_, State::loose)),
        may_link_(other.may_link_),
        provenance_(std::exchange(other.provenance_, {})) {}

  /// All pairs, in the order that was asked for.
  [[nodiscard]] std::span<const Pair> pairs() const noexcept { return {pairs_.data(), size()}; }
  /// Pairs in it.
  [[nodiscard]] std::size_t size() const noexcept { return pairs_.size(); }
  /// True without pairs.
  [[nodiscard]] bool empty() const noexcept { return pairs_.empty(); }
  /// Pair i, below `size()`.
  [[nodiscard]] const Pair& operator[](std::size_t i) const noexcept { return pairs_[i]; }
  /// The first pair.
  [[nodiscard]] const Pair* begin() const noexcept { return pairs_.begin(); }
  /// Behind the last pair.
  [[nodiscard]] const Pair* end() const noexcept { return pairs_.end(); }

  /// Room for `count` pairs. False if memory is refused. What it takes besides to find them is made
  /// ready by `Partition::reserve_pairs`.
  [[nodiscard]] bool reserve(std::size_t count, Pages pages = Pages::untouched) noexcept {
    return pairs_.reserve(count, pages);
  }

  /// Pairs that there is room for.
  [[nodiscard]] std::size_t capacity() const noexcept { return pairs_.capacity(); }
  /// Gives back the room for more than `count` pairs, or than it holds. False, and unchanged, if
  /// memory is refused. O(pairs).
  [[nodiscard]] bool shrink(std::size_t count) noexcept { return pairs_.shrink(count); }

  /// Takes the pairs of another buffer over as they are, so that the next query may go on from
  /// either. False, and unchanged, if memory is refused. O(pairs).
  [[nodiscard]] bool assign(const PairBuffer& other) noexcept;

  /// Forgets all pairs, so that the next query is a full one; memory is kept.
  void clear() noexcept {
    pairs_.clear();
    state_ = State::loose;
    provenance_ = {};
  }

  /// Empties it and gives its memory back.
  void release() noexcept;

  /// The pairs, to be changed at will.
  [[nodiscard]] Column<Pair>& edit() noexcept {
    state_ = State::loose;
    provenance_ = {};
    return pairs_;
  }

  /// Puts the pairs that `is_first(pair)` is true of before all others, and returns how many they
  /// are. The next query may go on from these pairs as from any. O(pairs), of which only those move
  /// that it is false of.
  template <typename IsFirst>
  [[nodiscard]] std::size_t partition(IsFirst&& is_first) noexcept {
    state_ = State::loose;
    std::size_t end = size();
    for (std::size_t i = 0; i < end;) {
      if (is_first(std::as_const(pairs_[i]))) {
        ++i;
      } else {
        std::swap(pairs_[i], pairs_[--end]);
      }
    }
    return end;
  }

  /// Bytes of pairs under `results`; links and what tasks wrote to under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class PairWriter;
  friend class PairTracker;
  friend class LinkedPairs;

  /// What leads from objects to pairs, and when that is made; see LinkedPairs.
  enum class State : std::uint8_t { loose, few_moved, linked };
  struct Link {
    std::uint32_t next[2];
    std::uint32_t before[2];
  };

  Column<Pair> pairs_;
  // What tasks write before their output is put in order; see PairWriter.
  Column<Pair> pages_;
  Column<std::uint64_t> page_table_;
  Column<Link> links_;
  Column<std::uint32_t> heads_;
  Column<std::uint32_t> places_;
  State state_ = State::loose;
  bool may_link_ = true;
  Provenance provenance_;
};

}  // namespace winnow
