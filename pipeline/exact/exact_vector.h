#pragma once

#include <winnow/core/pose.h>
#include "pipeline/exact/dyadic.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace winnow {

struct ExactVector {
  Dyadic x[3];
};

[[nodiscard]] inline ExactVector exact_vector(const Vec3d& v) noexcept {
  return {{v.x(), v.y(), v.z()}};
}

[[nodiscard]] inline ExactVector operator-(const ExactVector& a, const ExactVector& b) noexcept {
  return {{a.x[0] - b.x[0], a.x[1] - b.x[1], a.x[2] - b.x[2]}};
}

[[nodiscard]] inline ExactVector operator+(const ExactVector& a, const ExactVector& b) noexcept {
  return {{a.x[0] + b.x[0], a.x[1] + b.x[1], a.x[2] + b.x[2]}};
}

[[nodiscard]] inline ExactVector operator-(const ExactVector& a) noexcept {
  return {{-a.x[0], -a.x[1], -a.x[2]}};
}

[[nodiscard]] inline ExactVector operator*(const ExactVector& a, const Dyadic& s) noexcept {
  return {{a.x[0] * s, a.x[1] * s, a.x[2] * s}};
}

[[nodiscard]] inline Dyadic dot(const ExactVector& a, const ExactVector& b) noexcept {
  return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2];
}

[[nodiscard]] inline ExactVector cross(const ExactVector& a, const ExactVector& b) noexcept {
  return {{a.x[1] * b.x[2] - a.x[2] * b.x[1], a.x[2] * b.x[0] - a.x[0] * b.x[2],
           a.x[0] * b.x[1] - a.x[1] * b.x[0]}};
}

[[nodiscard]] inline bool is_zero(const ExactVector& a) noexcept {
  return a.x[0].sign() == 0 && a.x[1].sign() == 0 && a.x[2].sign() == 0;
}

/// A direction in double, scaled so that its largest component is about 1.
struct RoundedDirection {
  explicit RoundedDirection(const ExactVector& direction) noexcept {
    int top = std::numeric_limits<int>::min();
    for (const Dyadic& x : direction.x) {
      if (x.sign() != 0) top = std::max(top, x.highest_bit());
    }
    for (int k = 0; k < 3; ++k) {
      d[k] = direction.x[k].sign() == 0 ? 0.0 : direction.x[k].scaled(-top);
    }
  }
  double d[3];
};

struct ExactMatrix {
  ExactVector row[3];
};

[[nodiscard]] inline ExactVector column(const ExactMatrix& m, int k) noexcept {
  return {{m.row[0].x[k], m.row[1].x[k], m.row[2].x[k]}};
}

[[nodiscard]] inline ExactVector operator*(const ExactMatrix& m, const ExactVector& v) noexcept {
  return {{dot(m.row[0], v), dot(m.row[1], v), dot(m.row[2], v)}};
}

/// transpose(m) * v.
[[nodiscard]] inline ExactVector transposed_times(const ExactMatrix& m,
                                                  const ExactVector& v) noexcept {
  ExactVector result;
  for (int k = 0; k < 3; ++k) {
    result.x[k] = m.row[0].x[k] * v.x[0] + m.row[1].x[k] * v.x[1] + m.row[2].x[k] * v.x[2];
  }
  return result;
}

/// The square of a quaternion's length.
[[nodiscard]] inline Dyadic square_length(const Quaternion& q) noexcept {
  return Dyadic(q[0]) * q[0] + Dyadic(q[1]) * q[1] + Dyadic(q[2]) * q[2] + Dyadic(q[3]) * q[3];
}

/// The rotation matrix of a quaternion times its squared length: a polynomial without division.
[[nodiscard]] inline ExactMatrix scaled_rotation(const Quaternion& q) noexcept {
  const Dyadic w(q[0]);
  const Dyadic x(q[1]);
  const Dyadic y(q[2]);
  const Dyadic z(q[3]);
  const Dyadic two(2.0);
  const Dyadic ww = w * w;
  const Dyadic xx = x * x;
  const Dyadic yy = y * y;
  const Dyadic zz = z * z;
  const Dyadic xy = x * y;
  const Dyadic wz = w * z;
  const Dyadic xz = x * z;
  const Dyadic wy = w * y;
  const Dyadic yz = y * z;
  const Dyadic wx = w * x;
  return {{{{ww + xx - yy - zz, two * (xy - wz), two * (xz + wy)}},
           {{two * (xy + wz), ww - xx + yy - zz, two * (yz - wx)}},
           {{two * (xz - wy), two * (yz + wx), ww - xx - yy + zz}}}};
}

/// Number of bits between the lowest and the highest bit of a set of numbers. A polynomial of
/// degree d in them needs d times as many, plus a few for the sums.
class BitSpan {
 public:
  void include(double value) noexcept {
    const DoubleParts parts(value);
    if (parts.magnitude == 0) return;
    low_ = std::min(low_, parts.exponent + std::countr_zero(parts.magnitude));
    high_ = std::max(high_, parts.exponent + 63 - std::countl_zero(parts.magnitude));
  }
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

/// Bits of a pose's rotation matrix times the squared length of its quaternion.
[[nodiscard]] inline int rotation_bits(const Pose& pose) noexcept {
  BitSpan span;
  for (const double q : pose.orientation) span.include(q);
  return 2 * span.bits() + 2;
}

/// Returns whether polynomials of this degree in numbers of this many bits fit a Dyadic, with room
/// for sums and for partly filled digits at both ends.
[[nodiscard]] inline bool fits_dyadic(int degree, int bits) noexcept {
  constexpr int kSpare = 256;
  return degree * bits + kSpare <= 64 * kDyadicDigits;
}

}  // namespace winnow
