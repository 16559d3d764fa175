#pragma once

#include <winnow/core/cast.h>
#include "partitions/queries/cast.kernel.h"

#include <Eigen/Core>

namespace winnow {

/// Prepares the cast of a box along direction * [min_t, max_t]; the direction is not zero. Writes
/// in place, because copying a struct that was just written stalls on its stores.
void prepare_cast(KernelCast& cast, const Aabb& box, const Eigen::Vector3d& direction, double min_t,
                  double max_t) noexcept;

/// A ray is the cast of a point.
inline void prepare_cast(KernelCast& cast, const Ray& ray) noexcept {
  prepare_cast(cast, Aabb{ray.origin, ray.origin}, ray.direction.cast<double>(),
               static_cast<double>(ray.min_t), static_cast<double>(ray.max_t));
}

}  // namespace winnow
