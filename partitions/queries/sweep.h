#pragma once

#include <winnow/core/cast.h>
#include "partitions/queries/cast.kernel.h"

#include <Eigen/Core>

namespace winnow {

/// Prepares the sweep of a box along direction * [min_t, max_t]; the direction is not zero.
[[nodiscard]] Sweep make_sweep(const Aabb& box, const Eigen::Vector3d& direction, double min_t,
                               double max_t) noexcept;

/// A ray is the sweep of a point.
[[nodiscard]] inline Sweep make_sweep(const Ray& ray) noexcept {
  return make_sweep(Aabb{ray.origin, ray.origin}, ray.direction.cast<double>(),
                    static_cast<double>(ray.min_t), static_cast<double>(ray.max_t));
}

}  // namespace winnow
