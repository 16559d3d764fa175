#pragma once

#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// The scenes that the cost of filters is given for.
inline const std::vector<std::string> kFilterScenes{"uniform", "mixed"};

/// filters: questions to partitions whose objects have filters beside those without, see FilterRow.
void declare_filters(Results& results);
/// On one thread. Throws std::runtime_error after adding rows if an answer was wrong.
void add_filters(Results& results, const NamedScene& scene, std::size_t objects, std::uint64_t seed,
                 const std::vector<std::string>& partitions, std::size_t rounds = 15);

}  // namespace winnow::bench
