#pragma once

#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// The scenes for which the cost of filters is measured.
inline const std::vector<std::string> kFilterScenes{"uniform", "mixed"};

/// Adds the rows, measured on one thread. Throws std::runtime_error after that if an answer was
/// wrong.
void add_filters(Results& results, const NamedScene& scene, std::size_t objects, std::uint64_t seed,
                 const std::vector<std::string>& partitions, std::size_t rounds = 15);

}  // namespace winnow::bench
