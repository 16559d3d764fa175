#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/frustum.h>
#include "bench/common/random.h"

#include <Eigen/Core>
#include <span>

namespace winnow::bench {

/// The box around all bounded boxes; a unit box if there are none.
[[nodiscard]] Aabb world_of(std::span<const Aabb> boxes) noexcept;

/// Of unit length, uniform.
[[nodiscard]] Eigen::Vector3f random_direction(Random& random) noexcept;

/// A camera with a vertical field of view of 60 degrees, at random, that sees about this share of
/// the boxes: it stands in the world for small shares, before it for large ones, and its far plane
/// is put where the share is right.
[[nodiscard]] Frustum camera_that_sees(double share, std::span<const Aabb> boxes, const Aabb& world,
                                       Random& random);

}  // namespace winnow::bench
