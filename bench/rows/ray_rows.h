#pragma once

#include "bench/measure/ray_race.h"
#include "bench/rows/results.h"

namespace winnow::bench {

/// Runs a race of ray casts against a mesh.
RayMeasurement add_mesh_rays(Results& results, const RayRaceOptions& options);

}  // namespace winnow::bench
