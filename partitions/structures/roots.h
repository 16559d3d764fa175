#pragma once

#include <span>

namespace winnow {

/// Returns the root of degree 1, 2 or 3 of a product of finite factors >= 0, with an error of at
/// most four ulps. The product itself may exceed the range of double. The result is identical on
/// every machine, unlike `<cmath>`: cell sizes computed from it decide the order of rows, and when
/// structures are built. It is infinite or NaN if a factor is.
[[nodiscard]] double root_of_product(unsigned degree, std::span<const double> factors) noexcept;

/// As above, for one number.
[[nodiscard]] inline double root(unsigned degree, double value) noexcept {
  return root_of_product(degree, {&value, 1});
}

}  // namespace winnow
