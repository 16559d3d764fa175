#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {

/// The double nearest to `to - from`, and its rounding error: to - from = difference + rest
/// exactly, unless the difference overflows (it is then clamped to the largest double).
struct TwoDiff {
  double difference[3];
  double rest[3];
};

[[nodiscard]] inline TwoDiff difference(const double to[3], const double from[3]) noexcept {
  TwoDiff result{};
  constexpr double kMaxDouble = std::numeric_limits<double>::max();
  for (int i = 0; i < 3; ++i) {
    // The error of a floating-point difference is itself a double (TwoSum: Knuth, TAOCP vol. 2,
    // 4.2.2, theorem B).
    const double d = to[i] - from[i];
    const double back = d - to[i];
    const double rest = (to[i] - (d - back)) + (-from[i] - back);
    result.difference[i] = std::clamp(d, -kMaxDouble, kMaxDouble);
    result.rest[i] = std::isfinite(rest) ? rest : 0.0;
  }
  return result;
}

/// Returns between + rest + t * d with compensated sums, for a difference and its rounding error:
/// the error is relative to the result, not to the terms.
[[nodiscard]] inline double moved(double between, double rest, double t, double d) noexcept {
  const double step = t * d;
  const double step_error = std::fma(t, d, -step);
  const double sum = between + step;
  const double half = sum - step;
  const double sum_error = (between - half) + (step - (sum - half));
  return sum + (sum_error + step_error + rest);
}

}  // namespace winnow
