#pragma once

// PairBuffer, the caller's array of pairs. Queries of a Partition fill it, and update it from frame
// to frame: see PairWriter, PairTracker and LinkedPairs in partitions/pairs/.
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

/// Two objects that may touch. `self_pairs` writes first < second. `pairs_with` writes first an
/// object of the partition that it is called on, then an object of the other one.
struct Pair {
  ObjectId first = kNoObject;   ///< an id of the partition that was queried
  ObjectId second = kNoObject;  ///< an id of this partition, or of the other one

  /// Orders pairs by the first object, then by the second.
  friend constexpr auto operator<=>(const Pair&, const Pair&) noexcept = default;
};

/// The caller's array of pairs, reused from frame to frame. If the buffer is passed to the same
/// partition again, the query starts from the previous frame's pairs. If few objects moved, only
/// their pairs are recomputed. If at most one object in 48 moved in each of two consecutive frames,
/// the buffer also links each object to its pairs, and a frame visits only the pairs of objects
/// that moved. Links take 16 bytes per pair and 4 per object. Any other use (another partition,
/// `clear`, `edit`) makes the next query a full one. The set of pairs is the same in all cases. Not
/// thread-safe.
class WINNOW_API PairBuffer {
 public:
  /// Identifies the complete query that wrote the content; 0 is none.
  struct Provenance {
    std::uint64_t partition = 0;  ///< a number unique to the partition in the process
    std::uint64_t serial = 0;     ///< increases with each query
    /// True if both identify the same query.
    friend constexpr bool operator==(const Provenance&, const Provenance&) noexcept = default;
  };

  /// Creates an empty buffer. Every allocation comes from `memory`, which must outlive it.
  explicit PairBuffer(std::pmr::memory_resource* memory = default_memory()) noexcept
      : pairs_(memory),
        pages_(memory),
        page_table_(memory),
        links_(memory),
        heads_(memory),
        places_(memory) {}
  /// Takes the content of `other`, which becomes empty: its next query is a full one.
  PairBuffer(PairBuffer&& other) noexcept
      : pairs_(std::move(other.pairs_)),
        pages_(std::move(other.pages_)),
        page_table_(std::move(other.page_table_)),
        links_(std::move(other.links_)),
        heads_(std::move(other.heads_)),
        places_(std::move(other.places_)),
        state_(std::exchange(other.state_, LinkState::unlinked)),
        may_link_(other.may_link_),
        provenance_(std::exchange(other.provenance_, {})) {}

  /// Returns all pairs, in the order that the query requested.
  [[nodiscard]] std::span<const Pair> pairs() const noexcept { return {pairs_.data(), size()}; }
  /// Returns the number of pairs.
  [[nodiscard]] std::size_t size() const noexcept { return pairs_.size(); }
  /// True if there are no pairs.
  [[nodiscard]] bool empty() const noexcept { return pairs_.empty(); }
  /// Pair i; i must be below `size()`.
  [[nodiscard]] const Pair& operator[](std::size_t i) const noexcept { return pairs_[i]; }
  /// Iterators over all pairs.
  /// @{
  [[nodiscard]] const Pair* begin() const noexcept { return pairs_.begin(); }
  [[nodiscard]] const Pair* end() const noexcept { return pairs_.end(); }
  /// @}

  /// Ensures room for `count` pairs. Returns false if memory is refused. `Partition::reserve_pairs`
  /// reserves the other memory that finding them takes.
  [[nodiscard]] bool reserve(std::size_t count, Pages pages = Pages::untouched) noexcept {
    return pairs_.reserve(count, pages);
  }

  /// Returns the number of pairs that fit in the allocated memory.
  [[nodiscard]] std::size_t capacity() const noexcept { return pairs_.capacity(); }
  /// Frees the room for more than `count` pairs, or for more than `size()` if that is larger.
  /// Returns false, and changes nothing, if memory is refused. O(pairs).
  [[nodiscard]] bool shrink(std::size_t count) noexcept { return pairs_.shrink(count); }

  /// Copies the pairs of another buffer; the next query can start from either of the two. Returns
  /// false, and changes nothing, if memory is refused. O(pairs).
  [[nodiscard]] bool assign(const PairBuffer& other) noexcept;

  /// Removes all pairs: the next query is a full one. Memory is kept.
  void clear() noexcept {
    pairs_.clear();
    state_ = LinkState::unlinked;
    provenance_ = {};
  }

  /// Removes all pairs and frees the memory.
  void release() noexcept;

  /// Returns the pairs for arbitrary changes; the next query is a full one.
  [[nodiscard]] Column<Pair>& edit() noexcept {
    state_ = LinkState::unlinked;
    provenance_ = {};
    return pairs_;
  }

  /// Moves all pairs for which `is_first(pair)` is true before all others, and returns their
  /// number. The next query can still start from these pairs. O(pairs), with one swap for each pair
  /// for which `is_first` is false.
  template <typename IsFirst>
  [[nodiscard]] std::size_t partition(IsFirst&& is_first) noexcept {
    state_ = LinkState::unlinked;
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

  /// Returns the bytes of the buffer: pairs as `results`, and links and the buffers that tasks fill
  /// as `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class PairWriter;
  friend class PairTracker;
  friend class LinkedPairs;

  /// Whether objects are linked to their pairs, or will be linked if few objects move in the next
  /// frame too; see LinkedPairs.
  enum class LinkState : std::uint8_t { unlinked, few_moved, linked };
  struct Link {
    std::uint32_t next[2];
    std::uint32_t before[2];
  };

  Column<Pair> pairs_;
  // Output of tasks before it is put in order; see PairWriter.
  Column<Pair> pages_;
  Column<std::uint64_t> page_table_;
  Column<Link> links_;
  Column<std::uint32_t> heads_;
  Column<std::uint32_t> places_;
  LinkState state_ = LinkState::unlinked;
  bool may_link_ = true;
  Provenance provenance_;
};

}  // namespace winnow
