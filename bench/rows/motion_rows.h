#pragma once

#include "bench/measure/feature_race.h"
#include "bench/measure/impact_race.h"
#include "bench/measure/sweep_race.h"
#include "bench/rows/results.h"

namespace winnow::bench {

// What moves between two frames: when it meets what.

/// impacts, feature_impacts, swept_scenes.
void declare_motion(Results& results);

/// A race on moving pairs of one kind.
ImpactMeasurement add_impacts(Results& results, const ImpactRaceOptions& options);

/// Features of meshes in steps of each sort.
void add_feature_impacts(Results& results, std::size_t pairs, std::size_t rounds,
                         std::uint64_t seed);

/// A scene's sweeps beside its contacts.
void add_swept_scene(Results& results, const SweepRaceOptions& options);

}  // namespace winnow::bench
