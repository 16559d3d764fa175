#pragma once

#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <cstdint>

namespace winnow::bench {

struct EverySceneQuestion {
  NamedScene scene;
  std::size_t objects = 10'000;
  std::uint64_t seed = 1;
  int threads = 1;
  bool yardstick = true;    ///< beside, where the tool was built with it
  std::size_t frames = 61;  ///< the first one included
};

/// every_scene: the median, the worst and the first frame of partitions side by side.
void declare_every_scene(Results& results);
/// Of all partitions that suit any size. Throws std::runtime_error after that if not all found the
/// same pairs.
void add_every_scene(Results& results, const EverySceneQuestion& asked);

}  // namespace winnow::bench
