#pragma once

// Vectors of three dimensions, one per lane.

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// One vector per lane.
template <typename T>
struct Vec3 {
  Lanes<T> x;
  Lanes<T> y;
  Lanes<T> z;

  [[gnu::always_inline]] friend Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  [[gnu::always_inline]] friend Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  [[gnu::always_inline]] friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  [[gnu::always_inline]] friend Vec3 operator*(const Vec3& a, const Lanes<T>& s) {
    return {a.x * s, a.y * s, a.z * s};
  }
};

/// The sum of the magnitudes.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> taxicab(const Vec3<T>& v) {
  return abs(v.x) + abs(v.y) + abs(v.z);
}

template <typename T>
[[gnu::always_inline]] inline Lanes<T> dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename T>
[[gnu::always_inline]] inline Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename T>
[[gnu::always_inline]] inline Vec3<T> select(const LaneMask<T>& mask, const Vec3<T>& a,
                                             const Vec3<T>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

}  // namespace winnow::WINNOW_ISA_NAME
