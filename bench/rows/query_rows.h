#pragma once

#include "bench/measure/query_race.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>

namespace winnow::bench {

/// Runs a race of queries on the first frame of a scene, whose name and recording are written to
/// the options, and adds a row for each run that returned answers. Throws std::runtime_error after
/// that if a query was refused or not all engines found the same.
QueryMeasurement add_queries(Results& results, const NamedScene& scene,
                             QueryMeasureOptions options);

/// Adds frustum queries compared with reading every box. Throws QueryError.
void add_frusta(Results& results, std::size_t objects, std::size_t rounds);

}  // namespace winnow::bench
