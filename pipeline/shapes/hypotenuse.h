#pragma once

#include <algorithm>
#include <cmath>

namespace winnow {

/// sqrt(x^2 + y^2) of 0 <= y <= x whose squares are within range, to an ulp (Borges, "An improved
/// algorithm for hypot(a,b)", 2019).
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

/// sqrt(x^2 + y^2) of finite numbers to an ulp, without overflow or underflow on the way. The same
/// on every machine, which std::hypot is not: mathematical libraries differ in its last digit, and
/// one does by what the processor has.
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
