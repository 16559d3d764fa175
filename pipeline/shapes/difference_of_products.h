#pragma once

// Included by kernel files, which are compiled once per instruction set. Functions here are always
// inlined, so that no copy compiled for one instruction set is linked into another.

namespace winnow {

/// x * y - z * w with an error of one or two ulps (Kahan's algorithm; Jeannerod, Louvet and Muller
/// 2013).
[[nodiscard, gnu::always_inline]] inline double difference_of_products(double x, double y, double z,
                                                                       double w) noexcept {
  const double product = z * w;
  const double error = __builtin_fma(-z, w, product);
  return __builtin_fma(x, y, -product) + error;
}

}  // namespace winnow
