#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/frustum.h>
#include "bench/common/random.h"

#include <Eigen/Core>
#include <span>

namespace winnow::bench {

/// Returns the bounds of all bounded boxes; a unit box if there are none.
[[nodiscard]] Aabb world_of(std::span<const Aabb> boxes) noexcept;

/// Returns a random camera with a vertical field of view of 60 degrees that sees about this share
/// of the boxes. The camera is inside the world for small shares and outside for large ones; its
/// far plane is chosen so that the share is right.
[[nodiscard]] Frustum camera_that_sees(double share, std::span<const Aabb> boxes, const Aabb& world,
                                       Random& random);

}  // namespace winnow::bench
