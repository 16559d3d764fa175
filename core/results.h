#pragma once

// The caller's arrays to which queries of a Partition write: pairs, events of pairs, hits, objects
// in a region. The classes that fill them are in partitions/pairs/ and partitions/queries/.

#include <winnow/core/export.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <span>
#include <utility>

namespace winnow {

/// An array of results in the caller's memory resource, reused from query to query: a query with no
/// more results than an earlier one allocates nothing. It can be used like a span. Not thread-safe.
template <typename Result>
class ResultArray {
 public:
  /// Returns the number of results.
  [[nodiscard]] std::size_t size() const noexcept { return rows_.size(); }
  /// True if there are no results.
  [[nodiscard]] bool empty() const noexcept { return rows_.empty(); }
  /// Result i; i must be below `size()`.
  [[nodiscard]] const Result& operator[](std::size_t i) const noexcept { return rows_[i]; }
  /// Iterators over all results.
  /// @{
  [[nodiscard]] const Result* begin() const noexcept { return rows_.begin(); }  ///< first result
  [[nodiscard]] const Result* end() const noexcept { return rows_.end(); }      ///< behind the last
  /// @}

  /// Ensures room for `count` results. Returns false, and changes nothing, if memory is refused.
  [[nodiscard]] bool reserve(std::size_t count, Pages pages = Pages::untouched) noexcept {
    return rows_.reserve(count, pages);
  }
  /// Returns the number of results that fit in the allocated memory.
  [[nodiscard]] std::size_t capacity() const noexcept { return rows_.capacity(); }
  /// Frees the room for more than `count` results, or for more than `size()` if that is larger.
  /// Returns false, and changes nothing, if memory is refused. O(results).
  [[nodiscard]] bool shrink(std::size_t count) noexcept { return rows_.shrink(count); }

 protected:
  /// Creates an empty array, all of whose memory comes from `memory`.
  explicit ResultArray(std::pmr::memory_resource* memory) noexcept : rows_(memory) {}

  Column<Result> rows_;  ///< the results
};

/// Two objects that may touch. `self_pairs` writes first < second. `pairs_with` writes first an
/// object of the partition that it is called on, then an object of the other one.
struct Pair {
  ObjectId first = kNoObject;   ///< an id of the partition that was queried
  ObjectId second = kNoObject;  ///< an id of this partition, or of the other one

  /// Orders pairs by the first object, then by the second.
  friend constexpr auto operator<=>(const Pair&, const Pair&) noexcept = default;
};

namespace detail {

/// Whether objects are linked to their pairs, or will be linked if few objects move in the next
/// frame too; see LinkedPairs.
enum class LinkState : std::uint8_t { unlinked, few_moved, linked };

/// The next and the previous pair of each of the two objects of a pair.
struct PairLink {
  std::uint32_t next[2];
  std::uint32_t before[2];
};

}  // namespace detail

/// The caller's array of pairs, reused from frame to frame. If the buffer is passed to the same
/// partition again, the query starts from the previous frame's pairs. If few objects moved, only
/// their pairs are recomputed. If at most one object in 48 moved in each of two consecutive frames,
/// the buffer also links each object to its pairs, and a frame visits only the pairs of objects
/// that moved. Links take 16 bytes per pair and 4 per object. Any other use (another partition,
/// `clear`, `edit`) makes the next query a full one. The set of pairs is the same in all cases. Not
/// thread-safe.
class WINNOW_API PairBuffer : public ResultArray<Pair> {
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
      : ResultArray(memory),
        pages_(memory),
        page_table_(memory),
        links_(memory),
        heads_(memory),
        places_(memory) {}
  /// Takes the content of `other`, which becomes empty: its next query is a full one.
  PairBuffer(PairBuffer&& other) noexcept
      : ResultArray(std::move(other)),
        pages_(std::move(other.pages_)),
        page_table_(std::move(other.page_table_)),
        links_(std::move(other.links_)),
        heads_(std::move(other.heads_)),
        places_(std::move(other.places_)),
        state_(std::exchange(other.state_, LinkState::unlinked)),
        may_link_(other.may_link_),
        provenance_(std::exchange(other.provenance_, {})) {}

  /// Returns all pairs, in the order that the query requested. `Partition::reserve_pairs` reserves
  /// memory for them, and the other memory that finding them takes.
  [[nodiscard]] std::span<const Pair> pairs() const noexcept { return rows_; }

  /// Copies the pairs of another buffer; the next query can start from either of the two. Returns
  /// false, and changes nothing, if memory is refused. O(pairs).
  [[nodiscard]] bool assign(const PairBuffer& other) noexcept;

  /// Removes all pairs: the next query is a full one. Memory is kept.
  void clear() noexcept {
    rows_.clear();
    state_ = LinkState::unlinked;
    provenance_ = {};
  }

  /// Removes all pairs and frees the memory.
  void release() noexcept;

  /// Returns the pairs for arbitrary changes; the next query is a full one.
  [[nodiscard]] Column<Pair>& edit() noexcept {
    state_ = LinkState::unlinked;
    provenance_ = {};
    return rows_;
  }

  /// Moves all pairs for which `is_first(pair)` is true before all others, and returns their
  /// number. The next query can still start from these pairs. O(pairs), with one swap for each pair
  /// for which `is_first` is false.
  template <typename IsFirst>
  [[nodiscard]] std::size_t partition(IsFirst&& is_first) noexcept {
    state_ = LinkState::unlinked;
    std::size_t end = size();
    for (std::size_t i = 0; i < end;) {
      if (is_first(std::as_const(rows_[i]))) {
        ++i;
      } else {
        std::swap(rows_[i], rows_[--end]);
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

  using LinkState = detail::LinkState;

  // Output of tasks before it is put in order; see PairWriter.
  Column<Pair> pages_;
  Column<std::uint64_t> page_table_;
  Column<detail::PairLink> links_;
  Column<std::uint32_t> heads_;
  Column<std::uint32_t> places_;
  LinkState state_ = LinkState::unlinked;
  bool may_link_ = true;
  Provenance provenance_;
};

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
  [[nodiscard]] std::span<const KeyPair> begun() const noexcept { return begun_; }
  /// Returns the pairs of the previous frame that are not in this one, sorted by ids. The key of a
  /// removed object is stale.
  [[nodiscard]] std::span<const KeyPair> ended() const noexcept { return ended_; }
  /// Returns the client data of the pairs in `begun()`, in the same order; empty without the
  /// `client_data` option.
  [[nodiscard]] std::span<const ClientDataPair> begun_data() const noexcept { return begun_data_; }
  /// Returns the client data of the pairs in `ended()`, in the same order; empty without the
  /// `client_data` option. Data of a removed object are its own, even if its id was reused.
  [[nodiscard]] std::span<const ClientDataPair> ended_data() const noexcept { return ended_data_; }
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

/// A result of a ray, cast or nearest query.
struct Hit {
  Key key;              ///< the object; null if nothing was found
  ClientData data = 0;  ///< client data of the object
  /// Parameter of the first contact of the cast with the object's box, in units of the cast's
  /// direction; for a nearest query, the distance. It is computed in double and rounded down to a
  /// float.
  float t = std::numeric_limits<float>::infinity();

  /// True if an object was found.
  [[nodiscard]] explicit operator bool() const noexcept { return key.id != kNoObject; }
  /// True if object, data and t are equal.
  friend bool operator==(const Hit&, const Hit&) noexcept = default;
};

/// Columns of the caller for the results of a batch whose queries have one result each. A null
/// column is not written. A query without a result writes the null key, 0 and infinity.
struct HitColumns {
  Key* key = nullptr;          ///< keys of the objects
  ClientData* data = nullptr;  ///< client data of the objects
  float* t = nullptr;          ///< `Hit::t`; infinity if nothing was found
};

/// The caller's array of hits, reused from query to query: a query with no more hits than an
/// earlier one allocates nothing. Not thread-safe.
class WINNOW_API HitBuffer : public ResultArray<Hit> {
 public:
  /// Creates an empty buffer. Every allocation comes from `memory`, which must outlive it.
  explicit HitBuffer(std::pmr::memory_resource* memory = default_memory()) noexcept
      : ResultArray(memory), start_(memory), found_(memory), keys_(memory) {}

  /// Returns all hits; for a batch, the hits of each query one after the other.
  [[nodiscard]] std::span<const Hit> hits() const noexcept { return rows_; }

  /// Returns the number of queries in the last call: 1, or the size of the batch; 0 before the
  /// first call and after `clear`.
  [[nodiscard]] std::size_t queries() const noexcept {
    return start_.empty() ? 0 : start_.size() - 1;
  }
  /// Returns the hits of query i of a batch.
  [[nodiscard]] std::span<const Hit> of(std::size_t i) const noexcept {
    return {rows_.data() + start_[i], start_[i + 1] - start_[i]};
  }

  /// Removes all hits; memory is kept.
  void clear() noexcept {
    rows_.clear();
    start_.clear();
    found_.clear();
  }

  /// Returns the bytes of the buffer: hits as `results`, and the buffers that tasks fill before
  /// hits are sorted as `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class HitWriter;

  Column<std::size_t> start_;
  PairBuffer found_;            // hits of casts before they are sorted
  Column<std::uint64_t> keys_;  // sort keys: bits of t << 32 | id
};

/// The caller's array of objects that overlap a region, reused from query to query. Not
/// thread-safe.
class WINNOW_API OverlapBuffer : public ResultArray<ObjectId> {
 public:
  /// Creates an empty buffer. Every allocation comes from `memory`, which must outlive it.
  explicit OverlapBuffer(std::pmr::memory_resource* memory = default_memory()) noexcept
      : ResultArray(memory), crossing_(memory) {}
  /// Takes the content of `other`, which becomes empty.
  OverlapBuffer(OverlapBuffer&& other) noexcept
      : ResultArray(std::move(other)),
        crossing_(std::move(other.crossing_)),
        inside_(std::exchange(other.inside_, 0)) {}

  /// Returns every object whose box overlaps the region: first the inside ones, then the crossing
  /// ones.
  [[nodiscard]] std::span<const ObjectId> ids() const noexcept { return rows_; }
  /// Returns the objects whose boxes are entirely inside the region. A box that is inside by less
  /// than the rounding error may be returned as crossing.
  [[nodiscard]] std::span<const ObjectId> inside() const noexcept { return ids().first(inside_); }
  /// Returns all other objects.
  [[nodiscard]] std::span<const ObjectId> crossing() const noexcept {
    return ids().subspan(inside_);
  }
  /// Removes all objects; memory is kept.
  void clear() noexcept {
    rows_.clear();
    inside_ = 0;
  }

  /// Returns the bytes of the buffer: objects as `results`, and the temporary list of crossing
  /// objects as `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class OverlapWriter;

  Column<ObjectId> crossing_;
  std::size_t inside_ = 0;
};

}  // namespace winnow
