#pragma once

#include <winnow/pipeline/contacts.h>
#include "bench/contenders/scene_engine.h"

#include <memory>

namespace winnow::bench {

struct WinnowSceneOptions {
  double cache_tolerance = 0.0;  ///< above 0, contacts of resting pairs are cached between frames
  ContactLevel level = ContactLevel::manifold;
  double contact_margin = 0.0;
};

/// Makes the engine that runs a winnow Scene.
[[nodiscard]] std::unique_ptr<SceneEngine> make_winnow_scene(
    int threads, const WinnowSceneOptions& options = {});
[[nodiscard]] std::unique_ptr<MeshEngine> make_winnow_mesh();

}  // namespace winnow::bench
