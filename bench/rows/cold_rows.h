#pragma once

#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// The scenes whose first frames are measured.
inline const std::vector<std::string> kColdScenes{"uniform", "mixed", "clustered"};

/// Adds the rows of the first frame of a scene.
void add_cold(Results& results, const NamedScene& scene, std::size_t objects, std::uint64_t seed,
              const std::vector<std::string>& partitions, int threads, std::size_t rounds = 7,
              bool yardstick = true);

}  // namespace winnow::bench
