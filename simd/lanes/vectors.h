#pragma once

// Vectors of three dimensions, one per lane.

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

template <typename T, int Parts = kPartsOf<T>>
struct Vec3 {
  Lanes<T, Parts> x;
  Lanes<T, Parts> y;
  Lanes<T, Parts> z;

  [[gnu::always_inline]] friend Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  [[gnu::always_inline]] friend Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  [[gnu::always_inline]] friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  [[gnu::always_inline]] friend Vec3 operator*(const Vec3& a, const Lanes<T, Parts>& s) {
    return {a.x * s, a.y * s, a.z * s};
  }
};

/// Sum of the absolute coordinates (L1 norm).
template <typename T, int Parts>
[[gnu::always_inline]] inline Lanes<T, Parts> norm_l1(const Vec3<T, Parts>& v) {
  return abs(v.x) + abs(v.y) + abs(v.z);
}

template <typename T, int Parts>
[[gnu::always_inline]] inline Lanes<T, Parts> dot(const Vec3<T, Parts>& a,
                                                  const Vec3<T, Parts>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename T, int Parts>
[[gnu::always_inline]] inline Vec3<T, Parts> cross(const Vec3<T, Parts>& a,
                                                   const Vec3<T, Parts>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename T, int Parts>
[[gnu::always_inline]] inline Vec3<T, Parts> select(const LaneMask<T, Parts>& mask,
                                                    const Vec3<T, Parts>& a,
                                                    const Vec3<T, Parts>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

}  // namespace winnow::WINNOW_ISA_NAME
