#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace winnow::solver {

/// Multiplies by 2^-exponent, in two steps as that factor may be no double.
class Scale {
 public:
  explicit Scale(int exponent) noexcept {
    constexpr int kLargest = 1000;
    const int second = std::min(exponent + kLargest, 0);
    factor_[0] = power_of_two(second - exponent);
    factor_[1] = power_of_two(-second);
  }
  /// Multiplies by a factor that is a double.
  [[nodiscard]] static Scale by(double factor) noexcept {
    Scale scale(0);
    scale.factor_[0] = factor;
    return scale;
  }
  [[nodiscard]] double operator()(double x) const noexcept { return x * factor_[0] * factor_[1]; }

 private:
  [[nodiscard]] static double power_of_two(int exponent) noexcept {
    constexpr int kNormal = 1022;
    if (std::abs(exponent) > kNormal) return std::ldexp(1.0, exponent);
    return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + kNormal + 1) << 52U);
  }

  double factor_[2];
};

}  // namespace winnow::solver
