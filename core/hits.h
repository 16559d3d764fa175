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

/// An object that a ray, a cast or a nearest query found.
struct Hit {
  Key key;              ///< the object; null if nothing was found
  ClientData data = 0;  ///< that the object was inserted with
  /// Where the sweep first touches the object's box, in units of the sweep's direction; of a
  /// nearest query the distance. The exact value, rounded down to a float.
  float t = std::numeric_limits<float>::infinity();

  /// True if something was found.
  [[nodiscard]] explicit operator bool() const noexcept { return key.id != kNoObject; }
  /// The same object, data and t.
  friend bool operator==(const Hit&, const Hit&) noexcept = default;
};

/// Where a batch of questions that have one answer each writes them: columns of the caller, each
/// null if not wanted. A question without an answer gets the null key, 0 and infinity.
struct HitColumns {
  Key* key = nullptr;          ///< objects
  ClientData* data = nullptr;  ///< what they were inserted with
  float* t = nullptr;          ///< infinity where nothing was found
};

/// The caller's array of hits, reused from query to query; a query with as many hits as an earlier
/// one allocates nothing. Not for use from two threads at once.
class WINNOW_API HitBuffer {
 public:
  /// An empty buffer. Every allocation comes from `memory`, which must outlive it.
  explicit HitBuffer(std::pmr::memory_resource* memory = default_memory()) noexcept
      : hits_(memory), start_(memory), found_(memory), keys_(memory) {}

  /// All hits; of a batch those of its questions one after the other.
  [[nodiscard]] std::span<const Hit> hits() const noexcept { return {hits_.data(), size()}; }
  /// Hits of all questions.
  [[nodiscard]] std::size_t size() const noexcept { return hits_.size(); }
  /// True if nothing was hit.
  [[nodiscard]] bool empty() const noexcept { return hits_.empty(); }
  /// Hit i, below `size()`.
  [[nodiscard]] const Hit& operator[](std::size_t i) const noexcept { return hits_[i]; }
  /// The first hit.
  [[nodiscard]] const Hit* begin() const noexcept { return hits_.begin(); }
  /// Behind the last hit.
  [[nodiscard]] const Hit* end() const noexcept { return hits_.end(); }

  /// How many questions the last query had: 1, or the size of the batch.
  [[nodiscard]] std::size_t questions() const noexcept {
    return start_.empty() ? 0 : start_.size() - 1;
  }
  /// The hits of question i of a batch.
  [[nodiscard]] std::span<const Hit> of(std::size_t i) const noexcept {
    return {hits_.data() + start_[i], start_[i + 1] - start_[i]};
  }

  /// Forgets all hits; memory is kept.
  void clear() noexcept {
    hits_.clear();
    start_.clear();
    found_.clear();
  }
  /// Room for `count` hits. False if memory is refused.
  [[nodiscard]] bool reserve(std::size_t count) noexcept { return hits_.reserve(count); }

  /// Bytes under `results`; what tasks write before it is put in order under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class HitWriter;

  Column<Hit> hits_;
  Column<std::size_t> start_;
  PairBuffer found_;            // what casts found, before it is put in order
  Column<std::uint64_t> keys_;  // bits of t << 32 | id
};

/// The caller's array of objects that a region met, reused from query to query. Not for use from
/// two threads at once.
class WINNOW_API OverlapBuffer {
 public:
  /// An empty buffer. Every allocation comes from `memory`, which must outlive it.
  explicit OverlapBuffer(std::pmr::memory_resource* memory = default_memory()) noexcept
      : ids_(memory), crossing_(memory) {}
  /// `other` is left empty.
  OverlapBuffer(OverlapBuffer&& other) noexcept
      : ids_(std::move(other.ids_)),
        crossing_(std::move(other.crossing_)),
        inside_(std::exchange(other.inside_, 0)) {}

  /// Every object whose box meets the region: first those inside, then those crossing.
  [[nodiscard]] std::span<const ObjectId> ids() const noexcept { return {ids_.data(), size()}; }
  /// Objects whose boxes lie wholly in the region; one that does so by less than rounding may be
  /// among the crossing ones.
  [[nodiscard]] std::span<const ObjectId> inside() const noexcept { return ids().first(inside_); }
  /// All others.
  [[nodiscard]] std::span<const ObjectId> crossing() const noexcept {
    return ids().subspan(inside_);
  }
  /// Objects that meet the region, inside or crossing.
  [[nodiscard]] std::size_t size() const noexcept { return ids_.size(); }
  /// True if the region meets nothing.
  [[nodiscard]] bool empty() const noexcept { return ids_.empty(); }

  /// Forgets all objects; memory is kept.
  void clear() noexcept {
    ids_.clear();
    inside_ = 0;
  }
  /// Room for `count` objects. False if memory is refused.
  [[nodiscard]] bool reserve(std::size_t count) noexcept { return ids_.reserve(count); }

  /// Bytes under `results`; crossing objects on their way under `scratch`.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend class OverlapWriter;

  Column<ObjectId> ids_;
  Column<ObjectId> crossing_;
  std::size_t inside_ = 0;
};

}  // namespace winnow
