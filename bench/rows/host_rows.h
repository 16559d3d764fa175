#pragma once

#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

void add_hosts(Results& results, const NamedScene& scene, std::size_t objects, std::uint64_t seed,
               const std::vector<std::string>& partitions, int threads, std::size_t frames = 101);

}  // namespace winnow::bench
