#pragma once

#include <winnow/partitions/structures.h>
#include "bench/measure/race.h"
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// One partition in a race on the user's scene.
struct Advised {
  std::string partition;
  double first_ms = 0.0;  ///< ms of the frame in which it was built
  /// ms of the frames after the sixth; if these are fewer than three, of the frames after the
  /// first.
  std::vector<double> settled;
  double median_ms = 0.0;   ///< of `settled`
  double times_best = 0.0;  ///< median over the least median of partitions except AutoPartition
  std::size_t bytes = 0;    ///< bytes allocated, without results
  std::string why;          ///< reason in one sentence, from its counters
};

struct Advice {
  std::string scene;
  std::size_t objects = 0;
  std::size_t frames = 0;
  int threads = 1;
  double moving = 0.0;           ///< share of the objects that move in a frame
  double pairs = 0.0;            ///< per frame
  SceneFeatures features;        ///< of the last sample of AutoPartition
  std::vector<Advised> ranking;  ///< fastest first
  std::string chosen;            ///< AutoPartition's structure at the end
  std::string reason;
  bool same_pairs = true;  ///< all partitions found the same pairs

  /// Returns the fastest partition other than AutoPartition.
  [[nodiscard]] const Advised& best() const;
  /// Returns a line of C++ that creates the best partition.
  [[nodiscard]] std::string code() const;
};

/// Races the named partitions on `frames` frames of a source, interleaved. `features`, `chosen` and
/// `reason` are set only if AutoPartition is among the partitions. Throws std::invalid_argument if
/// `partitions` has no partition other than AutoPartition.
[[nodiscard]] Advice advise(FrameSource& source, const std::vector<std::string>& partitions,
                            std::size_t frames, int threads);

}  // namespace winnow::bench
