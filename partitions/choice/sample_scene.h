#pragma once

#include <winnow/partitions/structures.h>
#include "core/memory/bounds_pool.h"

#include <cstddef>

namespace winnow {

/// Computes features from a sample of the boxes of `live` objects. O(1).
[[nodiscard]] SceneFeatures sample_scene(const BoundsPool& pool, std::size_t live) noexcept;

}  // namespace winnow
