#pragma once

// Sixty-four bytes of float or double as one number with operators: 16 floats or 8 doubles on any
// instruction set, for kernel files that compute more than they compare. One template of a kernel
// serves both precisions. Every operation is rounded as IEEE 754 says and none is fused, so results
// are the same on every instruction set.

#include "simd/lanes/wide.h"

namespace winnow::WINNOW_ISA_NAME {

template <typename T>
struct Real;

/// A truth value a lane of Real<T>.
template <typename T>
struct Truth {
  static constexpr int kTruthParts = static_cast<int>(64 / sizeof(T) / xsimd::batch<T>::size);
  xsimd::batch_bool<T> part[kTruthParts];
};

template <typename T>
struct Real {
  using Batch = xsimd::batch<T>;
  static constexpr int kRealLanes = static_cast<int>(64 / sizeof(T));
  static constexpr int kBatchLanes = static_cast<int>(Batch::size);
  static constexpr int kBatches = kRealLanes / kBatchLanes;

  Batch part[kBatches];

  Real() = default;
  Real(T value) {  // NOLINT(google-explicit-constructor): numbers mix with lanes in formulas
    for (int i = 0; i < kBatches; ++i) part[i] = Batch(value);
  }

  /// `p` is 64-byte aligned.
  [[gnu::always_inline]] static Real load(const T* p) {
    Real r;
    for (int i = 0; i < kBatches; ++i) r.part[i] = Batch::load_aligned(p + i * kBatchLanes);
    return r;
  }
  [[gnu::always_inline]] static Real load_unaligned(const T* p) {
    Real r;
    for (int i = 0; i < kBatches; ++i) r.part[i] = Batch::load_unaligned(p + i * kBatchLanes);
    return r;
  }
  [[gnu::always_inline]] void store(T* p) const {
    for (int i = 0; i < kBatches; ++i) part[i].store_aligned(p + i * kBatchLanes);
  }
  [[gnu::always_inline]] void store_unaligned(T* p) const {
    for (int i = 0; i < kBatches; ++i) part[i].store_unaligned(p + i * kBatchLanes);
  }

#define WINNOW_REAL_OPERATOR(op)                                                 \
  [[gnu::always_inline]] friend Real operator op(const Real& a, const Real& b) { \
    Real r;                                                                      \
    for (int i = 0; i < kBatches; ++i) r.part[i] = a.part[i] op b.part[i];       \
    return r;                                                                    \
  }                                                                              \
  [[gnu::always_inline]] Real& operator op##=(const Real& b) {                   \
    return *this = *this op b;                                                   \
  }
  WINNOW_REAL_OPERATOR(+)
  WINNOW_REAL_OPERATOR(-)
  WINNOW_REAL_OPERATOR(*)
  WINNOW_REAL_OPERATOR(/)
#undef WINNOW_REAL_OPERATOR
  [[gnu::always_inline]] friend Real operator-(const Real& a) {
    Real r;
    // What xsimd makes of -0.0 depends on the instruction set.
    for (int i = 0; i < kBatches; ++i) r.part[i] = Batch(T(-0.0)) - a.part[i];
    return r;
  }

#define WINNOW_REAL_COMPARE(op)                                                      \
  [[gnu::always_inline]] friend Truth<T> operator op(const Real& a, const Real& b) { \
    Truth<T> r;                                                                      \
    for (int i = 0; i < kBatches; ++i) r.part[i] = a.part[i] op b.part[i];           \
    return r;                                                                        \
  }
  WINNOW_REAL_COMPARE(<)
  WINNOW_REAL_COMPARE(<=)
  WINNOW_REAL_COMPARE(>)
  WINNOW_REAL_COMPARE(>=)
  WINNOW_REAL_COMPARE(==)
#undef WINNOW_REAL_COMPARE
};

template <typename T>
[[gnu::always_inline]] inline Truth<T> operator&(const Truth<T>& a, const Truth<T>& b) {
  Truth<T> r;
  for (int i = 0; i < Truth<T>::kTruthParts; ++i) r.part[i] = a.part[i] & b.part[i];
  return r;
}
template <typename T>
[[gnu::always_inline]] inline Truth<T> operator|(const Truth<T>& a, const Truth<T>& b) {
  Truth<T> r;
  for (int i = 0; i < Truth<T>::kTruthParts; ++i) r.part[i] = a.part[i] | b.part[i];
  return r;
}
template <typename T>
[[gnu::always_inline]] inline Truth<T> operator!(const Truth<T>& a) {
  Truth<T> r;
  for (int i = 0; i < Truth<T>::kTruthParts; ++i) r.part[i] = ~a.part[i];
  return r;
}

/// a where the mask holds, b elsewhere.
template <typename T>
[[gnu::always_inline]] inline Real<T> select(const Truth<T>& mask, const Real<T>& a,
                                             const Real<T>& b) {
  Real<T> r;
  for (int i = 0; i < Real<T>::kBatches; ++i) {
    r.part[i] = xsimd::select(mask.part[i], a.part[i], b.part[i]);
  }
  return r;
}
/// Lane-wise smaller and larger; no lane may be NaN.
template <typename T>
[[gnu::always_inline]] inline Real<T> min(const Real<T>& a, const Real<T>& b) {
  Real<T> r;
  for (int i = 0; i < Real<T>::kBatches; ++i) r.part[i] = xsimd::min(a.part[i], b.part[i]);
  return r;
}
template <typename T>
[[gnu::always_inline]] inline Real<T> max(const Real<T>& a, const Real<T>& b) {
  Real<T> r;
  for (int i = 0; i < Real<T>::kBatches; ++i) r.part[i] = xsimd::max(a.part[i], b.part[i]);
  return r;
}
template <typename T>
[[gnu::always_inline]] inline Real<T> abs(const Real<T>& a) {
  Real<T> r;
  for (int i = 0; i < Real<T>::kBatches; ++i) r.part[i] = xsimd::abs(a.part[i]);
  return r;
}
template <typename T>
[[gnu::always_inline]] inline Real<T> sqrt(const Real<T>& a) {
  Real<T> r;
  for (int i = 0; i < Real<T>::kBatches; ++i) r.part[i] = xsimd::sqrt(a.part[i]);
  return r;
}

inline Mask16 bits(xsimd::batch_bool<double> b) {
#if defined(WINNOW_ISA_IS_avx512)
  return static_cast<__mmask8>(static_cast<typename xsimd::batch_bool<double>::register_type>(b));
#elif defined(WINNOW_ISA_IS_avx2)
  return static_cast<Mask16>(_mm256_movemask_pd(b));
#elif defined(WINNOW_ISA_IS_sse42)
  return static_cast<Mask16>(_mm_movemask_pd(b));
#else
  const uint64x2_t v = static_cast<uint64x2_t>(b);
  return static_cast<Mask16>((vgetq_lane_u64(v, 0) & 1U) | (vgetq_lane_u64(v, 1) & 2U));
#endif
}

/// One bit a lane; lane 0 is bit 0.
template <typename T>
[[gnu::always_inline]] inline Mask16 bits(const Truth<T>& mask) {
  Mask16 r = 0;
  for (int i = 0; i < Truth<T>::kTruthParts; ++i) {
    r |= bits(mask.part[i]) << (i * Real<T>::kBatchLanes);
  }
  return r;
}
/// All bits of a mask of Real<T>.
template <typename T>
inline constexpr Mask16 kAllLanes = (1U << Real<T>::kRealLanes) - 1U;

/// -1 where a is below zero, 1 elsewhere.
template <typename T>
[[gnu::always_inline]] inline Real<T> sign_or_one(const Real<T>& a) {
  return select(a < Real<T>(T(0)), Real<T>(T(-1)), Real<T>(T(1)));
}

/// A vector a lane.
template <typename T>
struct Vec3 {
  Real<T> x;
  Real<T> y;
  Real<T> z;

  [[gnu::always_inline]] friend Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  [[gnu::always_inline]] friend Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  [[gnu::always_inline]] friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  [[gnu::always_inline]] friend Vec3 operator*(const Vec3& a, const Real<T>& s) {
    return {a.x * s, a.y * s, a.z * s};
  }
};

template <typename T>
[[gnu::always_inline]] inline Real<T> dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename T>
[[gnu::always_inline]] inline Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename T>
[[gnu::always_inline]] inline Vec3<T> select(const Truth<T>& mask, const Vec3<T>& a,
                                             const Vec3<T>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

}  // namespace winnow::WINNOW_ISA_NAME
