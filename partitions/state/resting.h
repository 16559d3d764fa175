#pragma once

#include <winnow/core/column.h>
#include <winnow/core/footprint.h>
#include <winnow/core/key.h>

#include "partitions/rows/rows.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory_resource>

namespace winnow {

/// Detects resting scenes, in which boxes are deferred (see VerletSkin), and keeps the list of
/// close pairs that this requires.
///
/// In a resting scene objects jitter or get the same boxes again, and pairs hardly change. Rest is
/// detected from a sample of objects: over three frames with full pair queries, they stay so close
/// to their sampled positions that a skin of 1/16 of a typical edge is enough, and move at most 1.4
/// times as far as in the first of these frames. All objects then get a skin slightly wider than
/// the sampled motion. While two boxes stay within their skins, their overlap can change only if
/// the stored boxes are nearly touching. These pairs are watched, which costs one test of two boxes
/// per frame; all other pairs stay as they are. This is a Verlet list (Verlet, Phys. Rev. 159,
/// 1967), except that the result is exact. An object that leaves its skin is queried like any moved
/// object, with its box enlarged by two skins.
///
/// If small objects crowd beside large ones, and the size of the large ones determines the skin,
/// nearly every pair would be watched. Such a scene does not count as resting.
///
/// A false detection costs several full queries to start with. After each start that did not last
/// long enough to pay, the next attempt is delayed twice as long.
class RestDetector {
 public:
  struct WatchedPair {
    ObjectId first;
    ObjectId second;
    bool overlapped;  ///< overlapped in the last frame
  };

  explicit RestDetector(std::pmr::memory_resource* memory) noexcept
      : watched(memory), sample_(memory) {}

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
  /// Returns the largest number of watched pairs that still costs less than querying the objects
  /// again.
  [[nodiscard]] static std::size_t max_watched(std::size_t objects, std::size_t pairs) noexcept {
    return 8 * objects + pairs;
  }
  void note_frame() noexcept { ++frames_; }
  /// Reserves the sample. False if memory is refused.
  [[nodiscard]] bool reserve(Pages pages) noexcept { return sample_.reserve(kSample, pages); }
  /// Called when deferring ends or cannot start; sets the delay before the next attempt.
  void end() noexcept;
  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept;

  Column<WatchedPair> watched;

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

}  // namespace winnow
