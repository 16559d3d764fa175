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

// The other libraries that the tool was built with; none if without.

/// The engines of other libraries found when this was built, in the order in which reports list
/// them, each with its best settings for at most `threads` threads.
[[nodiscard]] std::vector<std::unique_ptr<Engine>> make_peers(int threads);

/// The same of those that answer questions, for any number of threads.
[[nodiscard]] std::vector<std::unique_ptr<QueryEngine>> make_query_peers();

/// The same of those that answer pairs of bodies. They use one thread.
[[nodiscard]] std::vector<std::unique_ptr<NarrowEngine>> make_narrow_peers();

/// The same of those that say when moving bodies meet. They use one thread.
[[nodiscard]] std::vector<std::unique_ptr<ImpactEngine>> make_impact_peers();

/// The same of those that find the contacts of whole scenes. They use one thread.
[[nodiscard]] std::vector<std::unique_ptr<SceneEngine>> make_scene_peers();

/// The same of those that take rays through a triangle mesh. They use one thread.
[[nodiscard]] std::vector<std::unique_ptr<RayEngine>> make_ray_peers();

/// The same of those that collide triangle meshes. They use one thread.
[[nodiscard]] std::vector<std::unique_ptr<MeshEngine>> make_mesh_peers();

}  // namespace winnow::bench
