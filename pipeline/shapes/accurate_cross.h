#pragma once

#include <Eigen/Core>
#include <cmath>

namespace winnow {

/// x * y - z * w to an ulp or two of the result (Kahan; Jeannerod, Louvet and Muller, 2013).
[[nodiscard]] inline double difference_of_products(double x, double y, double z,
                                                   double w) noexcept {
  const double product = z * w;
  const double error = std::fma(-z, w, product);
  return std::fma(x, y, -product) + error;
}

/// The product of two edges: of a sliver, too, a direction at right angles to both.
[[nodiscard]] inline Eigen::Vector3d accurate_cross(const Eigen::Vector3d& a,
                                                    const Eigen::Vector3d& b) noexcept {
  return {difference_of_products(a.y(), b.z(), a.z(), b.y()),
          difference_of_products(a.z(), b.x(), a.x(), b.z()),
          difference_of_products(a.x(), b.y(), a.y(), b.x())};
}

}  // namespace winnow
