#pragma once

#include "bench/contenders/ray_engine.h"

#include <memory>

namespace winnow::bench {

/// SceneQueries on a scene of one fixed mesh.
[[nodiscard]] std::unique_ptr<RayEngine> make_winnow_rays();

}  // namespace winnow::bench
