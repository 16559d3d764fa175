#pragma once

#include <winnow/core/column.h>
#include <winnow/partitions/partition.h>

#include <cstdint>
#include <ctime>
#include <memory_resource>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/counting_memory.h"

namespace winnow::test {

/// How long something runs, and how often it is looked at.
struct SoakPlan {
  std::uint64_t frames = 0;
  std::uint64_t seed = 1;
  int threads = 1;
  std::uint64_t objects = 256;  ///< at most; a quarter of them where each is tested with all others
  std::uint64_t check_every = 16;    ///< frames between two comparisons with the twin
  std::uint64_t save_every = 2000;   ///< frames between two snapshots
  std::uint64_t follow_frames = 16;  ///< that what was loaded goes on for beside what was saved
  /// Frames after which all is cleared and the same begins anew, which may ask for no more memory;
  /// 0: never. Of partitions alone.
  std::uint64_t lap = 0;
};

/// What was done, and what it took.
struct SoakTally {
  std::string name;
  std::uint64_t frames = 0;
  /// Objects and bodies that were added, removed, moved or told something, and questions.
  std::uint64_t operations = 0;
  /// Of two objects or bodies each, by the twin.
  std::uint64_t comparisons = 0;
  std::uint64_t checks = 0;     ///< frames whose answer was the twin's
  std::uint64_t snapshots = 0;  ///< that were loaded and went on alike
  std::uint64_t requests = 0;   ///< for memory, likewise
  /// After the last frame that asked for memory for itself, not for what is saved and loaded.
  std::uint64_t frames_without_requests = 0;
  std::size_t first_peak = 0;  ///< bytes in use at most, first half
  std::size_t last_peak = 0;   ///< and second half
  double median_us = 0.0;      ///< what a frame takes, checks not counted in
  double p999_us = 0.0;        ///< of a thousand frames the slowest
};

/// Throws with what did not hold.
inline void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

/// Times of frames, as numbers of those that took so long: steps of 1/64 of their size. On one
/// thread it is the thread's own time, in which nothing else that the machine does counts.
class FrameTimes {
 public:
  explicit FrameTimes(int threads)
      : clock_(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC) {}

  void begin() { start_ = now(); }
  void end();
  /// In microseconds, right to a sixty-fourth; 0 without frames.
  [[nodiscard]] double quantile(double share) const;

 private:
  static constexpr std::size_t kSteps = 64;
  /// In nanoseconds.
  [[nodiscard]] std::int64_t now() const;

  clockid_t clock_;
  std::int64_t start_ = 0;
  std::vector<std::uint64_t> counts_ = std::vector<std::uint64_t>(64 * kSteps);
  std::uint64_t frames_ = 0;
};

/// Watches that memory stays flat and that what is counted is what is held.
class MemoryWatch {
 public:
  /// `saved` is the memory of what is saved and loaded, which asks for some each time.
  MemoryWatch(SoakTally& tally, const CountingMemory& memory, const CountingMemory& saved,
              std::uint64_t frames)
      : tally_(tally), memory_(memory), saved_(saved), frames_(frames) {}

  /// After each frame; `held` is what footprints say.
  void look(std::uint64_t frame, std::size_t held);

 private:
  SoakTally& tally_;
  const CountingMemory& memory_;
  const CountingMemory& saved_;
  std::uint64_t frames_;
  std::uint64_t last_request_ = 0;
};

/// A partition of this structure, with objects that come, go, move and change their filters.
[[nodiscard]] SoakTally soak_partition(const StructureKind& structure, const SoakPlan& plan);

/// A scene with bodies that come, go, move, fall asleep, wake and change shapes and filters.
[[nodiscard]] SoakTally soak_scene(const SoakPlan& plan);

}  // namespace winnow::test
