#pragma once

#include "bench/contenders/engine.h"
#include "bench/contenders/impact_engine.h"
#include "bench/contenders/narrow_engine.h"
#include "bench/contenders/query_engine.h"
#include "bench/contenders/ray_engine.h"
#include "bench/contenders/scene_engine.h"

#include <memory>
#include <vector>

namespace winnow::bench {

// Engines of other libraries; all functions return none if the tool was built without them.

/// Broad-phase engines, in the order in which reports list them, each with its best settings for at
/// most `threads` threads.
[[nodiscard]] std::vector<std::unique_ptr<Engine>> make_peers(int threads);

/// Engines for queries on boxes, for any number of threads.
[[nodiscard]] std::vector<std::unique_ptr<QueryEngine>> make_query_peers();

/// Narrow-phase engines. They use one thread.
[[nodiscard]] std::vector<std::unique_ptr<NarrowEngine>> make_narrow_peers();

/// Engines for times of impact. They use one thread.
[[nodiscard]] std::vector<std::unique_ptr<ImpactEngine>> make_impact_peers();

/// Engines for contacts of whole scenes. They use one thread.
[[nodiscard]] std::vector<std::unique_ptr<SceneEngine>> make_scene_peers();

/// Engines for rays at a triangle mesh. They use one thread.
[[nodiscard]] std::vector<std::unique_ptr<RayEngine>> make_ray_peers();

/// Engines that collide triangle meshes. They use one thread.
[[nodiscard]] std::vector<std::unique_ptr<MeshEngine>> make_mesh_peers();

}  // namespace winnow::bench
