#pragma once

#include <winnow/pipeline/contacts.h>
#include "bench/contenders/scene_engine.h"

#include <memory>

namespace winnow::bench {

/// winnow on a scene. What rests is carried over if `carry_over` is above 0.
[[nodiscard]] std::unique_ptr<SceneEngine> make_winnow_scene(
    int threads, double carry_over, ContactLevel level = ContactLevel::manifold);
[[nodiscard]] std::unique_ptr<MeshEngine> make_winnow_mesh();

}  // namespace winnow::bench
