#pragma once

#include "bench/measure/scene_race.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <string>

namespace winnow::bench {

/// whole_scenes, scene_ratios, scene_levels, scene_costs, tori, mesh_builds.
/// Levels are told apart by scene and level alone, or by motion and threads as well.
void declare_scenes(Results& results, bool levels_by_setting = false);

/// A race on a scene of the whole pipeline, up to contact points.
PipelineMeasurement add_scene_race(Results& results, const PipelineMeasureOptions& options);
/// winnow alone, up to a level.
void add_scene_level(Results& results, PipelineMeasureOptions options, const std::string& level);
/// winnow alone: bytes of contacts, and what a margin costs.
void add_scene_costs(Results& results, const SceneCostOptions& options);
/// Two tori: contacts, and the tree that finds them.
MeshMeasurement add_tori(Results& results, std::size_t rounds, bool peers, bool machine_clock);

/// "pairs", "boolean", "distance", "manifold".
[[nodiscard]] std::vector<std::string> scene_level_names();

}  // namespace winnow::bench
