#pragma once

#include "bench/measure/race.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

namespace winnow::bench {

/// Runs a race on a scene, whose name and recording are written to the options, and adds the rows.
/// The time of a frame that was given up is the time until then, a lower bound. Throws
/// std::runtime_error after that if not all found the same pairs.
Measurement add_beside_peers(Results& results, const NamedScene& scene, MeasureOptions options);

}  // namespace winnow::bench
