#pragma once

#include <algorithm>
#include <cmath>

namespace winnow {

/// sqrt(x^2 + y^2) for 0 <= y <= x whose squares neither overflow nor underflow, with an error of
/// at most an ulp (Borges, "An improved algorithm for hypot(a,b)", 2019).
[[nodiscard]] inline double corrected_hypotenuse(double x, double y) noexcept {
  const double h = std::sqrt(x * x + y * y);
  if (h <= 2.0 * y) {
    const double beyond = h - y;
    return h - (x * (2.0 * beyond - x) + (beyond - 2.0 * (x - y)) * beyond) / (2.0 * h);
  }
  const double beyond = h - x;
  return h -
         (2.0 * beyond * (x - 2.0 * y) + ((4.0 * beyond - y) * y + beyond * beyond)) / (2.0 * h);
}

/// sqrt(x^2 + y^2) of finite numbers with an error of at most an ulp, without intermediate overflow
/// or underflow. Returns the same bits on every machine, unlike std::hypot: mathematical libraries
/// differ in its last digit, one of them even by the processor.
[[nodiscard]] inline double hypotenuse(double x, double y) noexcept {
  constexpr double kNegligible = 0x1p-54;
  constexpr double kScale = 0x1p-600;
  const double most = std::max(std::abs(x), std::abs(y));
  const double least = std::min(std::abs(x), std::abs(y));
  if (least <= most * kNegligible) return most + least;
  if (most > 0x1p511) return corrected_hypotenuse(most * kScale, least * kScale) / kScale;
  if (least < 0x1p-459) return corrected_hypotenuse(most / kScale, least / kScale) * kScale;
  return corrected_hypotenuse(most, least);
}

}  // namespace winnow
