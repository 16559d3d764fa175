#pragma once

#include "bench/measure/ray_race.h"
#include "bench/rows/results.h"

namespace winnow::bench {

/// mesh_rays, ray_meshes.
void declare_mesh_rays(Results& results);

/// A race of rays through a mesh.
RayMeasurement add_mesh_rays(Results& results, const RayRaceOptions& options);

}  // namespace winnow::bench
