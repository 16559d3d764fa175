#pragma once

#include "bench/measure/race.h"
#include "bench/rows/results.h"

#include <span>
#include <string>

namespace winnow::bench {

/// choice: AutoPartition over the best other partition, in "settled" and in the "first" frames.
void declare_choice(Results& results);

/// Of the settled frames of a race, a row for each number of threads.
void add_settled_choice(Results& results, const std::string& scene, const Measurement& measured);

}  // namespace winnow::bench
