#pragma once

#include <winnow/core/column.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/pair_buffer.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <span>
#include <utility>

namespace winnow {

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
class WINNOW_API HitBuffer {
 public:
  /// Creates an empty buffer. Every allocation comes from `memory`, which must outlive it.
  explicit HitBuffer(std::pmr::memory_resource* memory = default_memory()) noexcept
      : hits_(memory), start_(memory), found_(memory), keys_(memory) {}

  /// Returns all hits; for a batch, the hits of each query one after the other.
  [[nodiscard]] std::span<const Hit> hits() const noexcept { return {hits_.data(), size()}; }
  /// Returns the number of hits of all queries.
  [[nodiscard]] std::size_t size() const noexcept { return hits_.size(); }
  /// True if there are no hits.
  [[nodiscard]] bool empty() const noexcept { return hits_.empty(); }
  /// Hit i; i must be below `size()`.
  [[nodiscard]] const Hit& operator[](std::size_t i) const noexcept { return hits_[i]; }
  /// Iterators over all hits.
  /// @{
  [[nodiscard]] const Hit* begin() const noexcept { return hits_.begin(); }
  [[nodiscard]] const Hit* end() const noexcept { return hits_.end(); }
  /// @}

  /// Returns the number of queries in the last call: 1, or the size of the batch; 0 before the
  /// first call and after `clear`.
  [[nodiscard]] std::size_t queries() const noexcept {
    return start_.empty() ? 0 : start_.size() - 1;
  }
  /// Returns the hits of query i of a batch.
  [[nodiscard]] std::span<const Hit> of(std::size_t i) const noexcept {
    return {hits_.data() + start_[i], start_[i + 1] - start_[i]};
  }

  /// Removes all hits; memory is kept.
  void clear() noexcept {
    hits_.clear();
    start_.clear();
    found_.clear();
  }
  /// Ensures room for `count` hits. Returns false if memory is refused.
  [[nodiscard]] bool reserve(std::size_t count) noexcept { return hits_.reserve(count); }

  /// Returns the bytes of the buffer: hits as `results`, and the buffers that tasks fill before
  /// hits are sorted as `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class HitWriter;

  Column<Hit> hits_;
  Column<std::size_t> start_;
  PairBuffer found_;            // hits of casts before they are sorted
  Column<std::uint64_t> keys_;  // sort keys: bits of t << 32 | id
};

/// The caller's array of objects that overlap a region, reused from query to query. Not
/// thread-safe.
class WINNOW_API OverlapBuffer {
 public:
  /// Creates an empty buffer. Every allocation comes from `memory`, which must outlive it.
  explicit OverlapBuffer(std::pmr::memory_resource* memory = default_memory()) noexcept
      : ids_(memory), crossing_(memory) {}
  /// Takes the content of `other`, which becomes empty.
  OverlapBuffer(OverlapBuffer&& other) noexcept
      : ids_(std::move(other.ids_)),
        crossing_(std::move(other.crossing_)),
        inside_(std::exchange(other.inside_, 0)) {}

  /// Returns every object whose box overlaps the region: first the inside ones, then the crossing
  /// ones.
  [[nodiscard]] std::span<const ObjectId> ids() const noexcept { return {ids_.data(), size()}; }
  /// Returns the objects whose boxes are entirely inside the region. A box that is inside by less
  /// than the rounding error may be returned as crossing.
  [[nodiscard]] std::span<const ObjectId> inside() const noexcept { return ids().first(inside_); }
  /// Returns all other objects.
  [[nodiscard]] std::span<const ObjectId> crossing() const noexcept {
    return ids().subspan(inside_);
  }
  /// Returns the number of objects, inside or crossing.
  [[nodiscard]] std::size_t size() const noexcept { return ids_.size(); }
  /// True if no object overlaps the region.
  [[nodiscard]] bool empty() const noexcept { return ids_.empty(); }

  /// Removes all objects; memory is kept.
  void clear() noexcept {
    ids_.clear();
    inside_ = 0;
  }
  /// Ensures room for `count` objects. Returns false if memory is refused.
  [[nodiscard]] bool reserve(std::size_t count) noexcept { return ids_.reserve(count); }

  /// Returns the bytes of the buffer: objects as `results`, and the temporary list of crossing
  /// objects as `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class OverlapWriter;

  Column<ObjectId> ids_;
  Column<ObjectId> crossing_;
  std::size_t inside_ = 0;
};

}  // namespace winnow
