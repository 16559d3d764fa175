#pragma once

#include <span>

namespace winnow {

/// The root of a degree of 1, 2 or 3 of the product of finite numbers >= 0, to four ulps, where the
/// product itself may be beyond what a double holds. The same on every machine, which those of
/// `<cmath>` are not: what they decide, such as how wide cells are, decides the order of rows and
/// when they are built anew. Infinite or NaN if a factor is.
[[nodiscard]] double root_of_product(unsigned degree, std::span<const double> factors) noexcept;

/// The same of one number.
[[nodiscard]] inline double root(unsigned degree, double value) noexcept {
  return root_of_product(degree, {&value, 1});
}

}  // namespace winnow
