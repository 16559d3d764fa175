#pragma once

#include "bench/measure/race.h"
#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

namespace winnow::bench {

/// beside_peers: other libraries over the best partition of the same race, in the frames that both
/// ran: the median, or the mean where the scene grows, or the one frame that a library gave up.
void declare_beside_peers(Results& results);

/// Races on a scene, whose name and recording go into the options. A library that was given up is
/// told by what it had taken by then: at least so many times the best. Throws std::runtime_error
/// after that if not all found the same pairs.
Measurement add_beside_peers(Results& results, const NamedScene& scene, MeasureOptions options);

}  // namespace winnow::bench
