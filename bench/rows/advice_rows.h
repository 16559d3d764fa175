#pragma once

#include "bench/measure/advice.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// Adds the rows. Throws std::runtime_error after that if not all partitions found the same pairs.
Advice add_advice(Results& results, const NamedScene& scene, std::size_t objects,
                  std::uint64_t seed, const std::vector<std::string>& partitions,
                  std::size_t frames, int threads);

}  // namespace winnow::bench
