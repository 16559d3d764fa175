#pragma once

#include <winnow/partitions/scene_features.h>
#include "bench/measure/race.h"
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// One partition in a race on somebody's scene.
struct Advised {
  std::string partition;
  double first_ms = 0.0;  ///< of the frame in which it was built
  std::vector<double>
      settled;              ///< ms of the frames after the first six, or after the first of a few
  double median_ms = 0.0;   ///< of those
  double times_best = 0.0;  ///< over that of the fastest
  std::size_t bytes = 0;    ///< held, without results
  std::string why;          ///< one sentence from its counters
};

struct Advice {
  std::string scene;
  std::size_t objects = 0;
  std::size_t frames = 0;
  int threads = 1;
  double moving = 0.0;           ///< share of the objects that move in a frame
  double pairs = 0.0;            ///< a frame
  SceneFeatures features;        ///< of the last sample that AutoPartition took
  std::vector<Advised> ranking;  ///< fastest first
  std::string chosen;            ///< by AutoPartition, in the end
  std::string reason;
  bool same_pairs = true;  ///< all found the same

  /// The fastest that is not AutoPartition.
  [[nodiscard]] const Advised& best() const;
  /// A line of C++ that makes it.
  [[nodiscard]] std::string code() const;
};

/// Races the partitions, AutoPartition among them, on `frames` frames of a source, interleaved.
/// Throws std::invalid_argument if there are no partitions but AutoPartition.
[[nodiscard]] Advice advise(FrameSource& source, const std::vector<std::string>& partitions,
                            std::size_t frames, int threads);

}  // namespace winnow::bench
