#pragma once

// Numbers, vectors and rotations of one pair at a time; vectors are arrays.

namespace winnow::WINNOW_ISA_NAME {

static inline double largest_of(double a, double b) {
  return a > b ? a : b;
}
static inline double least_of(double a, double b) {
  return a < b ? a : b;
}
static inline double dot3(const double* a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline float dot3(const float* a, const float* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline void cross3(const double* a, const double* b, double* r) {
  r[0] = a[1] * b[2] - a[2] * b[1];
  r[1] = a[2] * b[0] - a[0] * b[2];
  r[2] = a[0] * b[1] - a[1] * b[0];
}
/// r = M x and r = M^T x, with M stored by rows.
template <typename T>
[[gnu::always_inline]] static inline void turn3(const T* m, const T* x, T* r) {
  for (int i = 0; i < 3; ++i) r[i] = m[3 * i] * x[0] + m[3 * i + 1] * x[1] + m[3 * i + 2] * x[2];
}
template <typename T>
static inline void turn_back3(const T* m, const T* x, T* r) {
  for (int i = 0; i < 3; ++i) r[i] = m[i] * x[0] + m[3 + i] * x[1] + m[6 + i] * x[2];
}

}  // namespace winnow::WINNOW_ISA_NAME
