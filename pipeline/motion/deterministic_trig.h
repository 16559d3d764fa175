#pragma once

#include <winnow/core/pose.h>

#include <cmath>

namespace winnow::impact {

struct SineCosine {
  double sine;
  double cosine;
};

/// Returns the sine and cosine of an angle of magnitude at most RigidMotion::kMaxTurn, with an
/// error of about 1e-16. The results are the same on every machine; results of the C library are
/// not. The nearest multiple of pi / 2 is subtracted in two parts; the first part has so few digits
/// that its multiples are exact (Cody, Waite, "Software manual for the elementary functions",
/// 1980). The remainder is the argument of the Taylor series.
[[nodiscard]] inline SineCosine sine_cosine(double angle) noexcept {
  constexpr double kQuarters = 6.36619772367581382433e-01;
  constexpr double kHigh = 1.57079632673412561417e+00;
  constexpr double kLow = 6.07710050650619224932e-11;
  const double quarters = std::nearbyint(angle * kQuarters);
  const double x = (angle - quarters * kHigh) - quarters * kLow;
  const double z = x * x;
  double sine = -1.0 / 1307674368000.0;
  for (const double term : {1.0 / 6227020800.0, -1.0 / 39916800.0, 1.0 / 362880.0, -1.0 / 5040.0,
                            1.0 / 120.0, -1.0 / 6.0}) {
    sine = sine * z + term;
  }
  sine = x + x * (z * sine);
  double cosine = 1.0 / 20922789888000.0;
  for (const double term : {-1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0,
                            1.0 / 40320.0, -1.0 / 720.0, 1.0 / 24.0, -0.5}) {
    cosine = cosine * z + term;
  }
  cosine = 1.0 + z * cosine;
  switch (static_cast<long long>(quarters) & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

/// An orientation of length 1, rotated by an angle about a unit axis.
[[nodiscard]] inline Quaternion turned(const Quaternion& from, const double axis[3],
                                       double angle) noexcept {
  const SineCosine half = sine_cosine(0.5 * angle);
  return Quaternion(half.cosine, half.sine * axis[0], half.sine * axis[1], half.sine * axis[2]) *
         from;
}

}  // namespace winnow::impact
