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

/// When boxes are deferred (see DeferredBoxes), and the pairs that this leaves open.
///
/// Much moves and hardly a pair changes where things rest and tremble, or are told to be where they
/// are. It is taken for that where a sample of objects, over some frames in which all pairs were
/// asked for, moves by little of its size, and in all of them by no more than in the first. All
/// then get a margin of somewhat more than that. Two boxes that each stay within it can change
/// whether they overlap only if their stored ones are nearly in touch: those pairs are watched,
/// which is a test of two boxes each in a frame, and all others stay as they are (the lists of
/// Verlet, Phys. Rev. 159, 1967, but that the answer is exact). What leaves its margin asks like
/// any object that moved, with a box larger by two margins, which finds all that it may meet.
///
/// Where small objects crowd together beside large ones, whose margin they get, next to all of them
/// are nearly in touch: such a scene is not taken for one at rest.
///
/// A scene that only seemed to rest pays for the beginning, some queries for all pairs, in vain:
/// after each time that was not worth it, it waits twice as long.
class Calm {
 public:
  struct Watched {
    ObjectId first;
    ObjectId second;
    bool met;  ///< in the last frame
  };

  explicit Calm(std::pmr::memory_resource* memory) noexcept : watched(memory), sample_(memory) {}

  /// Looks at the boxes after a frame in which all pairs were asked for. True if the scene seems to
  /// rest.
  [[nodiscard]] bool seems_at_rest(const Rows& rows) noexcept;
  /// For boxes that go on moving as the sample did.
  [[nodiscard]] float margin() const noexcept {
    return std::max(kSpare * furthest_, kLeast * edge_);
  }

  /// So many of so many objects came, went, or got another filter: where that is some in a hundred,
  /// their pairs change though they rest.
  void disturb(std::size_t count, std::size_t objects) noexcept {
    if (kFewDisturbed * count > objects) looks_ = 0;
  }
  /// How many pairs are worth watching: a test of two boxes takes some 3 ns, as does each pair that
  /// is found anew, and each object that asks some 25.
  [[nodiscard]] static std::size_t most_watched(std::size_t objects, std::size_t pairs) noexcept {
    return 8 * objects + pairs;
  }
  void note_frame() noexcept { ++frames_; }
  /// Room for the sample. False if memory is refused.
  [[nodiscard]] bool reserve(Pages pages) noexcept { return sample_.reserve(kSample, pages); }
  /// Boxes are deferred no longer, or memory for that was refused.
  void end() noexcept;
  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept;

  Column<Watched> watched;

 private:
  struct Sampled {
    Key key;
    float min[3];
    float max[3];
  };

  [[nodiscard]] bool take_sample(const Rows& rows) noexcept;
  [[nodiscard]] float step_of_sample(const Rows& rows) const noexcept;

  // Tremors that were sampled are somewhat shorter than the longest.
  static constexpr float kSpare = 1.5F;
  // Shares of an edge: with more, too many pairs would have to be watched; with less, no fewer.
  static constexpr float kMost = 1.0F / 16.0F;
  static constexpr float kLeast = 1.0F / 2048.0F;
  static constexpr std::size_t kSample = 32;
  static constexpr std::size_t kLooks = 3;
  static constexpr std::size_t kFewDisturbed = 32;
  // Frames that a beginning has to last to be worth it, and queries to wait at most.
  static constexpr std::size_t kWorthwhile = 16;
  static constexpr std::size_t kLongest = 4096;

  Column<Sampled> sample_;
  std::size_t looks_ = 0;  // at the sample, since it was taken
  float first_ = 0.0F;     // step of the sample in the first frame
  float furthest_ = 0.0F;  // in any
  float edge_ = 0.0F;      // longest one of a typical object
  std::size_t frames_ = 0;
  std::size_t wait_ = 0;
  std::size_t waiting_ = 0;
};

}  // namespace winnow
