#include "partitions/structures/roots.h"

#include <cmath>

namespace winnow {
namespace {

// Cube root of a number in [0.5, 4) by Newton's method. The initial error is at most an eighth and
// is squared six times.
double cube_root(double value) noexcept {
  double x = 0.6 + 0.28 * value;
  for (int i = 0; i < 6; ++i) x -= (x * x * x - value) / (3.0 * x * x);
  return x;
}

}  // namespace

double root_of_product(unsigned degree, std::span<const double> factors) noexcept {
  double product = 1.0;
  int exponent = 0;
  const auto normalise = [&exponent](double value) {
    int own = 0;
    const double fraction = std::frexp(value, &own);
    exponent += own;
    return fraction;
  };
  for (const double factor : factors) product = normalise(product * normalise(factor));
  if (!std::isfinite(product) || product == 0.0) return product;
  // The remainder of the divided exponent moves into the fraction.
  const int divisor = static_cast<int>(degree);
  const int rest = (exponent % divisor + divisor) % divisor;
  product = std::ldexp(product, rest);
  if (degree == 2) product = std::sqrt(product);
  if (degree == 3) product = cube_root(product);
  return std::ldexp(product, (exponent - rest) / divisor);
}

}  // namespace winnow
