#pragma once

#include "bench/measure/race.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

namespace winnow::bench {

/// Declares beside_peers: other libraries relative to the best partition of the same race, in the
/// frames that both ran. Compares the median of the frames after the first, or the mean if the
/// scene grows. If the library gave up its first or second frame, compares this frame.
void declare_beside_peers(Results& results);

/// Runs a race on a scene, whose name and recording are written to the options, and adds the rows.
/// The time of a frame that was given up is the time until then, a lower bound. Throws
/// std::runtime_error after that if not all found the same pairs.
Measurement add_beside_peers(Results& results, const NamedScene& scene, MeasureOptions options);

}  // namespace winnow::bench
