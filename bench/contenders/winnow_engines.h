#pragma once

#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/narrow_phase.h>
#include "bench/contenders/engines.h"

#include <memory>

namespace winnow::bench {

// Engines that run winnow. They throw std::runtime_error if winnow returns an error.

/// Makes the engine that runs a NarrowPhase in one tier; its name is the tier's.
[[nodiscard]] std::unique_ptr<NarrowEngine> make_winnow_narrow(NarrowTier tier, int threads = 1);

/// Makes the engine that calls winnow's function for one pair, in one tier, once per pair.
[[nodiscard]] std::unique_ptr<NarrowEngine> make_winnow_one_pair(NarrowTier tier);

/// Makes the engine that calls `time_of_impact`, on one thread.
[[nodiscard]] std::unique_ptr<ImpactEngine> make_winnow_impacts();

struct WinnowSceneOptions {
  double cache_tolerance = 0.0;  ///< above 0, contacts of resting pairs are cached between frames
  ContactLevel level = ContactLevel::manifold;
  double contact_margin = 0.0;
};

/// Makes the engine that runs a winnow Scene.
[[nodiscard]] std::unique_ptr<SceneEngine> make_winnow_scene(
    int threads, const WinnowSceneOptions& options = {});

/// Makes the engine that builds a TriangleMesh and collides two bodies of it in a Scene.
[[nodiscard]] std::unique_ptr<MeshEngine> make_winnow_mesh();

/// Makes the engine that runs SceneQueries on a scene of one fixed mesh.
[[nodiscard]] std::unique_ptr<RayEngine> make_winnow_rays();

}  // namespace winnow::bench
