#pragma once

// Pairs of resting scenes: a Verlet list. PairFinder owns it and queries it; PartitionState passes
// it the boxes of updates while it is active.

#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include <winnow/core/results.h>
#include <winnow/core/status.h>
#include <winnow/core/volumes.h>
#include "partitions/rows/rows.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

class LinkedPairs;
class SpatialIndex;
struct UpdateSubset;

/// Detects resting scenes.
///
/// In a resting scene objects jitter or get the same boxes again, and pairs hardly change. Rest is
/// detected from a sample of objects: over three frames with full pair queries, they stay so close
/// to their sampled positions that a skin of 1/16 of a typical edge is enough, and move at most 1.4
/// times as far as in the first of these frames.
///
/// A false detection costs several full queries to start with. After each start that did not last
/// long enough to pay, the next attempt is delayed twice as long.
class RestDetector {
 public:
  explicit RestDetector(std::pmr::memory_resource* memory) noexcept : sample_(memory) {}

  /// Samples the boxes after a frame with a full pair query. True if the scene seems to rest.
  [[nodiscard]] bool seems_at_rest(const Rows& rows) noexcept;
  /// Returns the skin for boxes that keep moving as the sample did.
  [[nodiscard]] float skin() const noexcept {
    return std::max(kMotionFactor * furthest_, kMinSkin * edge_);
  }

  /// Called when `count` of `objects` objects were inserted, removed or got another filter. If
  /// these are more than 1/32 of the objects, pairs change although objects rest, and detection
  /// starts again.
  void disturb(std::size_t count, std::size_t objects) noexcept {
    if (kFewDisturbed * count > objects) frames_compared_ = 0;
  }
  void note_frame() noexcept { ++frames_; }
  /// Reserves the sample. False if memory is refused.
  [[nodiscard]] bool reserve(Pages pages) noexcept { return sample_.reserve(kSample, pages); }
  /// Called when deferring ends or cannot start; sets the delay before the next attempt.
  void end() noexcept;
  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  struct SampledBox {
    Key key;
    float min[3];
    float max[3];
  };

  [[nodiscard]] bool take_sample(const Rows& rows) noexcept;
  [[nodiscard]] float step_of_sample(const Rows& rows) const noexcept;

  // The longest motion is longer than the longest sampled one.
  static constexpr float kMotionFactor = 1.5F;
  // Fractions of an object's edge. A wider skin would watch too many pairs; a narrower one would
  // not reduce their number further.
  static constexpr float kMaxSkin = 1.0F / 16.0F;
  static constexpr float kMinSkin = 1.0F / 2048.0F;
  static constexpr std::size_t kSample = 32;
  static constexpr std::size_t kFramesToCompare = 3;
  static constexpr std::size_t kFewDisturbed = 32;
  // Frames that deferring must last to pay, and the longest delay in queries before the next
  // attempt.
  static constexpr std::size_t kWorthwhile = 16;
  static constexpr std::size_t kLongest = 4096;

  Column<SampledBox> sample_;
  std::size_t frames_compared_ = 0;  // frames compared with the sample
  float first_ = 0.0F;               // motion of the sample in the first frame
  float furthest_ = 0.0F;            // largest motion in any frame
  float edge_ = 0.0F;                // longest edge of a typical object
  std::size_t frames_ = 0;
  std::size_t delay_ = 0;
  std::size_t delay_left_ = 0;
};

/// A Verlet list (Verlet, Phys. Rev. 159, 1967), except that the result is exact.
///
/// When the scene comes to rest, all objects get a skin slightly wider than the sampled motion.
/// While two boxes stay within their skins, their overlap can change only if the stored boxes are
/// nearly touching. These pairs are watched, which costs one test of two boxes per frame; all other
/// pairs stay as they are. An object that leaves its skin is queried like any moved object, with
/// its box enlarged by two skins.
///
/// While the list is `active`, boxes are deferred: an update does not write a row if every end of
/// the new box is within the skin of the stored end. Such an update costs one pass over both arrays
/// in the order of ids, and invalidates neither rows nor structures nor trees. `write` brings the
/// rows up to date. Given and stored boxes are arrays by id: 48 bytes per object once the list has
/// been active.
///
/// If small objects crowd beside large ones, and the size of the large ones determines the skin,
/// nearly every pair would be watched. Such a scene does not count as resting.
class RestingPairs {
 public:
  RestingPairs(std::pmr::memory_resource* memory, Rows& rows, const SpatialIndex& index) noexcept
      : rows_(rows),
        index_(index),
        detector_(memory),
        watched_(memory),
        given_(memory),
        stored_(memory),
        departed_(memory),
        near_(memory) {}

  [[nodiscard]] bool active() const noexcept { return active_.load(std::memory_order_acquire); }

  // Called by mutations.

  /// Updates boxes while active. Boxes outside the skin are written to their rows. If these are
  /// more than 1/32 of the objects, plus 16, all rows are written and the list ends.
  Status update(const UpdateSubset& entries, const BoxView& boxes);
  /// As above for one object; the list never ends here.
  Status update(Key key, const Aabb& box);
  /// Adds objects that were inserted while active. False if memory is refused; the caller must then
  /// write and end.
  [[nodiscard]] bool insert(std::span<const Key> keys, const BoxView& boxes) noexcept;
  /// See RestDetector::disturb.
  void disturb(std::size_t count) noexcept { detector_.disturb(count, rows_.size()); }
  /// Writes all given boxes to the rows. False if no box was given since the list was started.
  bool write() noexcept;
  /// Ends the list without writing.
  void end() noexcept;

  /// Reads the last box that each object was given. Requires an active list and valid keys.
  void read_bounds(std::span<const Key> keys, std::span<Aabb> boxes) const noexcept;

  // Called by pair queries.

  /// Called after a full query that wrote `out`: starts the list if the scene rests. If memory is
  /// refused, it does not start.
  void try_start(PairBuffer& out) noexcept;
  /// True if updating `out` by the list costs less than a full query. Requires an active list.
  [[nodiscard]] bool is_cheaper(const PairBuffer& out) const noexcept;
  /// Appends the pairs of the objects in the selected rows, which left their skins or were changed
  /// otherwise, and watches those whose overlap may change. Adds the number of tests to `tests`.
  Status query_moved(PairBuffer& out, std::uint64_t& tests);
  /// Adds the watched pairs that began or ended to `linked`. False if memory is refused.
  [[nodiscard]] bool note_watched(LinkedPairs& linked) noexcept;
  void note_frame() noexcept { detector_.note_frame(); }

  [[nodiscard]] bool reserve(Pages pages) noexcept { return detector_.reserve(pages); }
  /// Frees memory; not active.
  void release() noexcept;
  void add_bytes(Footprint& footprint) const noexcept;

 private:
  struct DeferredBox {
    float min[3];
    float max[3];
  };
  struct WatchedPair {
    ObjectId first;
    ObjectId second;
    bool overlapped;  // in the last frame
  };
  struct NearBatch;

  [[nodiscard]] static DeferredBox as_given(const Aabb& box) noexcept;
  [[nodiscard]] static BoxView view_of(const DeferredBox* boxes, std::size_t count) noexcept;
  [[nodiscard]] bool copy(const UpdateSubset& entries, const BoxView& boxes) noexcept;
  [[nodiscard]] bool start(float skin) noexcept;
  void drop() noexcept;
  [[nodiscard]] std::size_t max_watched(std::size_t pairs) const noexcept;
  [[nodiscard]] bool watch_all(std::size_t most) noexcept;
  [[nodiscard]] bool watch_rows(std::size_t begin, std::size_t end, std::size_t stride) noexcept;
  [[nodiscard]] bool is_watched(const Pair& pair) const noexcept;
  [[nodiscard]] bool overlap(ObjectId a, ObjectId b) const noexcept;
  Status query_near(std::span<const std::uint32_t> query_rows, PairBuffer& out,
                    std::uint64_t& tests) const;
  [[nodiscard]] bool keep_near(PairBuffer& out, std::size_t kept) noexcept;

  Rows& rows_;
  const SpatialIndex& index_;
  RestDetector detector_;
  Column<WatchedPair> watched_;
  Column<DeferredBox> given_;   // by id: the last box that each live object was given
  Column<DeferredBox> stored_;  // by id: the box in its row, infinite ends as infinite
  Column<std::uint32_t> departed_;
  PairBuffer near_;  // scratch for finding the pairs to watch
  float skin_ = 0.0F;
  std::uint32_t max_departed_ = 0;  // limit of objects that leave the skin in one update
  bool pending_ = false;            // boxes were given that their rows do not contain
  std::atomic<bool> active_{false};
};

}  // namespace winnow
