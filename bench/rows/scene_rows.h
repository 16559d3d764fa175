#pragma once

#include "bench/measure/scene_race.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <string>

namespace winnow::bench {

/// Declares whole_scenes, scene_ratios, scene_levels and scene_costs. The keys of
/// levels are scene and level, and with `levels_by_setting` also motion and threads.
void declare_scenes(Results& results, bool levels_by_setting = false);

/// Runs a race on a scene of the whole pipeline, up to contact points.
PipelineMeasurement add_scene_race(Results& results, const PipelineMeasureOptions& options);
/// Measures only winnow, up to a level.
void add_scene_level(Results& results, PipelineMeasureOptions options, const std::string& level);
/// Measures only winnow: bytes of contacts, and the cost of a contact margin.
void add_scene_costs(Results& results, const SceneCostOptions& options);

/// Returns "pairs", "boolean", "distance", "manifold".
[[nodiscard]] std::vector<std::string> scene_level_names();

}  // namespace winnow::bench
