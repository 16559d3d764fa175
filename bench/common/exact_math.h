#pragma once

#include <cmath>
#include <cstdint>

namespace winnow::bench {

// Powers and roots that use only + - * / and sqrt, which IEEE 754 rounds the same on every machine.
// std::cbrt and std::pow may differ.

/// Cube root of a positive number by Newton's method. The iteration starts above the root and
/// decreases until rounding stops it.
[[nodiscard]] inline double cube_root(double a) noexcept {
  double x = a > 1.0 ? a : 1.0;
  for (;;) {
    const double next = (2.0 * x + a / (x * x)) / 3.0;
    if (!(next < x)) return x;
    x = next;
  }
}

/// base^u for u in [0, 1), rounded down to 32 bits: the product of base^(1/2), base^(1/4), ... over
/// the set bits of u.
[[nodiscard]] inline double power(double base, double u) noexcept {
  auto bits = static_cast<std::uint32_t>(u * 0x1p32);
  double result = 1.0;
  for (double root = std::sqrt(base); bits != 0; bits <<= 1U, root = std::sqrt(root)) {
    if ((bits & 0x80000000U) != 0) result *= root;
  }
  return result;
}

}  // namespace winnow::bench
