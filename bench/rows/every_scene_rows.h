#pragma once

#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <cstdint>

namespace winnow::bench {

struct EverySceneOptions {
  NamedScene scene;
  std::size_t objects = 10'000;
  std::uint64_t seed = 1;
  int threads = 1;
  bool yardstick = true;    ///< measure the yardstick too, if the tool was built with it
  std::size_t frames = 61;  ///< including the first one
};

/// Adds the rows of all partitions without a size limit. Throws std::runtime_error after that if
/// not all found the same pairs.
void add_every_scene(Results& results, const EverySceneOptions& options);

}  // namespace winnow::bench
