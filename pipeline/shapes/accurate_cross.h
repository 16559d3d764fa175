#pragma once

#include "pipeline/shapes/difference_of_products.h"

#include <Eigen/Core>

namespace winnow {

/// Cross product of two edges with an error of a few ulps per component, so that the normal of a
/// sliver is accurate.
[[nodiscard]] inline Eigen::Vector3d accurate_cross(const Eigen::Vector3d& a,
                                                    const Eigen::Vector3d& b) noexcept {
  return {difference_of_products(a.y(), b.z(), a.z(), b.y()),
          difference_of_products(a.z(), b.x(), a.x(), b.z()),
          difference_of_products(a.x(), b.y(), a.y(), b.x())};
}

}  // namespace winnow
