#pragma once

#include <winnow/partitions/scene_features.h>
#include "core/memory/bounds_pool.h"

#include <cstddef>

namespace winnow {

/// Looks at a sample of the boxes of `live` objects. O(1) whatever the scene's size.
[[nodiscard]] SceneFeatures sample_scene(const BoundsPool& pool, std::size_t live) noexcept;

}  // namespace winnow
