#pragma once

// Kernel files include this: inlined always, since what they inline is built for one instruction
// set.

namespace winnow {

/// x * y - z * w to an ulp or two of the result (Kahan; Jeannerod, Louvet and Muller, 2013).
[[nodiscard, gnu::always_inline]] inline double difference_of_products(double x, double y, double z,
                                                                       double w) noexcept {
  const double product = z * w;
  const double error = __builtin_fma(-z, w, product);
  return __builtin_fma(x, y, -product) + error;
}

}  // namespace winnow
