#pragma once

#include <winnow/core/vectors.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

namespace winnow::oracle {

/// 100 decimal digits without heap memory: more than enough for doubles, rotations and small
/// determinants of them.
using Number = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>,
                                             boost::multiprecision::et_off>;

template <typename T>
struct Vector {
  T x{};
  T y{};
  T z{};

  friend Vector operator+(const Vector& a, const Vector& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend Vector operator-(const Vector& a, const Vector& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend Vector operator*(const Vector& a, const T& s) { return {a.x * s, a.y * s, a.z * s}; }
};

template <typename T>
T dot(const Vector<T>& a, const Vector<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <typename T>
Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <typename T>
T length(const Vector<T>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

/// `v` is not zero.
template <typename T>
Vector<T> unit(const Vector<T>& v) {
  return v * (T(1) / length(v));
}

[[nodiscard]] inline bool is_zero(const Vector<Number>& v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

inline Vector<Number> exact(const Vec3d& v) {
  return {v.x(), v.y(), v.z()};
}

inline Vector<double> rounded(const Vector<Number>& v) {
  return {v.x.convert_to<double>(), v.y.convert_to<double>(), v.z.convert_to<double>()};
}

}  // namespace winnow::oracle
