#pragma once

#include "bench/measure/continuous_race.h"
#include "bench/measure/feature_race.h"
#include "bench/measure/impact_race.h"
#include "bench/rows/results.h"

namespace winnow::bench {

// Continuous collision detection: times of impact of moving shapes, features and scenes.

/// Runs a race on moving pairs of one kind.
ImpactMeasurement add_impacts(Results& results, const ImpactRaceOptions& options);

/// Adds times of impact of mesh features for each kind of step.
void add_feature_impacts(Results& results, std::size_t pairs, std::size_t rounds,
                         std::uint64_t seed);

/// Adds the impacts of a scene, compared with its contacts.
void add_continuous_collision(Results& results, const ContinuousRaceOptions& options);

}  // namespace winnow::bench
