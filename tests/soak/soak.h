#pragma once

#include <winnow/core/memory.h>
#include <winnow/partitions/partition.h>

#include <cstdint>
#include <ctime>
#include <memory_resource>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/counting_memory.h"

namespace winnow::test {

/// The length of a run, and how often it is checked.
struct SoakPlan {
  std::uint64_t frames = 0;
  std::uint64_t seed = 1;
  int threads = 1;
  std::uint64_t objects = 256;       ///< maximum; a quarter if all pairs are tested
  std::uint64_t check_every = 16;    ///< frames between two comparisons with the reference
  std::uint64_t save_every = 2000;   ///< frames between two snapshots
  std::uint64_t follow_frames = 16;  ///< frames in which a loaded copy is compared
  /// Frames after which the partition is cleared and the random numbers begin again. The repeated
  /// frames must need no more memory. 0: never. Scenes ignore it.
  std::uint64_t lap = 0;
};

/// The totals of a run.
struct SoakTally {
  std::string name;
  std::uint64_t frames = 0;
  /// Additions, removals, moves and other changes of objects and bodies, and queries.
  std::uint64_t operations = 0;
  /// Tests of two objects or bodies by the reference.
  std::uint64_t comparisons = 0;
  std::uint64_t checks = 0;     ///< frames whose results equal the reference
  std::uint64_t snapshots = 0;  ///< loaded snapshots that continued identically
  std::uint64_t requests = 0;   ///< memory requests, of all of these
  /// Since the last frame that allocated memory, except for snapshots.
  std::uint64_t frames_without_requests = 0;
  std::size_t first_peak = 0;  ///< maximum of bytes in use, first half
  std::size_t last_peak = 0;   ///< and second half
  double median_us = 0.0;      ///< time of a frame, without checks
  double p999_us = 0.0;        ///< exceeded by one frame in a thousand
};

/// Throws `what` if the condition does not hold.
inline void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

/// A histogram of frame times with steps of 1/64 of their size. On one thread it counts the CPU
/// time of the thread, so that other work of the machine does not count.
class FrameTimes {
 public:
  explicit FrameTimes(int threads)
      : clock_(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC) {}

  void begin() { start_ = now(); }
  void end();
  /// Returns the quantile in microseconds, with a relative error of 1/64; 0 without frames.
  [[nodiscard]] double quantile(double share) const;

 private:
  static constexpr std::size_t kSteps = 64;
  /// Returns the time of the clock in nanoseconds.
  [[nodiscard]] std::int64_t now() const;

  clockid_t clock_;
  std::int64_t start_ = 0;
  std::vector<std::uint64_t> counts_ = std::vector<std::uint64_t>(64 * kSteps);
  std::uint64_t frames_ = 0;
};

/// Checks that memory stays flat and that footprints equal the memory in use.
class MemoryWatch {
 public:
  /// `saved` is the memory for snapshots, which allocates in every frame with a snapshot.
  MemoryWatch(SoakTally& tally, const CountingMemory& memory, const CountingMemory& saved,
              std::uint64_t frames)
      : tally_(tally), memory_(memory), saved_(saved), frames_(frames) {}

  /// Called after each frame; `held` is the sum of the footprints.
  void look(std::uint64_t frame, std::size_t held);

 private:
  SoakTally& tally_;
  const CountingMemory& memory_;
  const CountingMemory& saved_;
  std::uint64_t frames_;
  std::uint64_t last_request_ = 0;
};

/// A partition of this structure, with objects that arrive, leave, move and change their filters.
[[nodiscard]] SoakTally soak_partition(const StructureKind& structure, const SoakPlan& plan);

/// A scene with bodies that arrive, leave, move, fall asleep, wake and change shapes and filters.
[[nodiscard]] SoakTally soak_scene(const SoakPlan& plan);

}  // namespace winnow::test
