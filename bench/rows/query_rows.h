#pragma once

#include "bench/measure/query_race.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>

namespace winnow::bench {

/// queries, and frusta.
void declare_queries(Results& results);

/// Races on the first frame of a scene, whose name and recording go into the options, and adds a
/// row for each run that answered. Throws std::runtime_error after that if a question was refused,
/// or if not all found the same.
QueryMeasurement add_queries(Results& results, const NamedScene& scene,
                             QueryMeasureOptions options);

/// Frusta beside reading every box. Throws Refusal.
void add_frusta(Results& results, std::size_t objects, std::size_t rounds);

}  // namespace winnow::bench
