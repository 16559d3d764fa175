#pragma once

#include <winnow/core/pose.h>
#include "pipeline/exact/dyadic.h"

#include <algorithm>
#include <limits>

namespace winnow {

/// Bits between the lowest and the highest that any of some numbers has: what a polynomial of them
/// needs is that times its degree, and a few for the sums.
class BitSpan {
 public:
  void include(const Dyadic& value) noexcept {
    if (value.sign() == 0) return;
    low_ = std::min(low_, value.lowest_bit());
    high_ = std::max(high_, value.highest_bit());
  }
  [[nodiscard]] int bits() const noexcept { return high_ < low_ ? 0 : high_ - low_ + 1; }

 private:
  int low_ = std::numeric_limits<int>::max();
  int high_ = std::numeric_limits<int>::min();
};

/// Bits of the rotation of a pose times the square of its quaternion's length.
[[nodiscard]] inline int rotation_bits(const Pose& pose) noexcept {
  BitSpan span;
  for (const double q : pose.orientation) span.include(q);
  return 2 * span.bits() + 2;
}

/// True if polynomials of this degree in numbers of so many bits fit a Dyadic, with digits to spare
/// for sums and for ends that fill no digit.
[[nodiscard]] inline bool fits_dyadic(int degree, int bits) noexcept {
  constexpr int kSpare = 256;
  return degree * bits + kSpare <= 64 * kDyadicDigits;
}

}  // namespace winnow
