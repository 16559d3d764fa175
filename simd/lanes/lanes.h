#pragma once

// Lanes<T>: sixty-four bytes of one number type as one value with operators: 16 floats, 16 unsigned
// or 8 doubles on any instruction set. For kernel files only. A value is one register on AVX-512,
// two on AVX2, four on SSE4.2 and NEON. A block is 16 rows everywhere, so kernels visit rows and
// write results in the same order on every instruction set. Kernels that are templates of T can be
// instantiated for float and double. Every operation is rounded by IEEE 754 and none is fused
// (except multiply_add), so results are the same on every instruction set.
//
// Only the headers of this folder use xsimd (8.1 to 14) and intrinsics. xsimd 8.1 has no bit mask
// of a batch_bool, no compress and no reduction by min or max: this folder implements them per
// instruction set.

#ifndef WINNOW_ISA_NAME
#error "lanes.h is for *.kernel.cpp files, which the build compiles once per instruction set"
#endif

#include <cstdint>
#include <xsimd/xsimd.hpp>

namespace winnow::WINNOW_ISA_NAME {

/// Rows of a block, and lanes of float and unsigned.
inline constexpr int kLanes = 16;

/// One bit per lane; lane 0 is bit 0.
using Mask16 = std::uint32_t;

/// All lanes of a block.
inline constexpr Mask16 kAllRows = 0xFFFFU;

/// Returns the number of set bits.
inline unsigned count(Mask16 mask) {
  return static_cast<unsigned>(__builtin_popcount(mask));
}
/// Returns the index of the lowest set bit; `mask` must not be 0.
inline unsigned first(Mask16 mask) {
  return static_cast<unsigned>(__builtin_ctz(mask));
}
/// Returns the lowest n lanes, n <= 16.
inline constexpr Mask16 lanes_below(unsigned n) {
  return (1U << n) - 1U;
}

/// Number of registers for sixty-four bytes of T.
template <typename T>
inline constexpr int kPartsOf = static_cast<int>(64 / sizeof(T) / xsimd::batch<T>::size);

/// A truth value per lane of Lanes<T>, in the representation of the registers; `bits` converts it
/// to a mask.
template <typename T, int Parts = kPartsOf<T>>
struct LaneMask {
  using Part = xsimd::batch_bool<T>;
  static constexpr int kParts = Parts;

  Part part[kParts];

  [[gnu::always_inline]] friend LaneMask operator&(const LaneMask& a, const LaneMask& b) {
    LaneMask r;
    for (int i = 0; i < kParts; ++i) r.part[i] = a.part[i] & b.part[i];
    return r;
  }
  [[gnu::always_inline]] friend LaneMask operator|(const LaneMask& a, const LaneMask& b) {
    LaneMask r;
    for (int i = 0; i < kParts; ++i) r.part[i] = a.part[i] | b.part[i];
    return r;
  }
  [[gnu::always_inline]] friend LaneMask operator!(const LaneMask& a) {
    LaneMask r;
    for (int i = 0; i < kParts; ++i) r.part[i] = ~a.part[i];
    return r;
  }
};

// For floats on NEON, xsimd 8.1 divides and takes roots by Newton's method, which is not rounded by
// IEEE 754 and makes the root of infinity NaN. Hence these functions use the instructions of NEON.
template <typename Part>
[[gnu::always_inline]] inline Part quotient(const Part& a, const Part& b) {
#if defined(WINNOW_ISA_IS_neon64)
  if constexpr (sizeof(typename Part::value_type) == sizeof(float)) return vdivq_f32(a, b);
#endif
  return a / b;
}
template <typename Part>
[[gnu::always_inline]] inline Part square_root(const Part& a) {
#if defined(WINNOW_ISA_IS_neon64)
  if constexpr (sizeof(typename Part::value_type) == sizeof(float)) return vsqrtq_f32(a);
#endif
  return xsimd::sqrt(a);
}

/// `Parts` registers of T. With one part it is a single register, for computations that do not fill
/// 64 bytes.
template <typename T, int Parts = kPartsOf<T>>
struct Lanes {
  using Part = xsimd::batch<T>;
  using Mask = LaneMask<T, Parts>;
  static constexpr int kParts = Parts;
  static constexpr int kPartLanes = static_cast<int>(Part::size);
  static constexpr int kCount = kParts * kPartLanes;

  Part part[kParts];

  Lanes() = default;
  [[gnu::always_inline]] Lanes(T value) {  // NOLINT(google-explicit-constructor)
    for (int i = 0; i < kParts; ++i) part[i] = Part(value);
  }

  /// `p` must be 64-byte aligned.
  [[gnu::always_inline]] static Lanes load(const T* p) {
    Lanes r;
    for (int i = 0; i < kParts; ++i) r.part[i] = Part::load_aligned(p + i * kPartLanes);
    return r;
  }
  [[gnu::always_inline]] static Lanes load_unaligned(const T* p) {
    Lanes r;
    for (int i = 0; i < kParts; ++i) r.part[i] = Part::load_unaligned(p + i * kPartLanes);
    return r;
  }
  /// `p` must be 64-byte aligned.
  [[gnu::always_inline]] void store(T* p) const {
    for (int i = 0; i < kParts; ++i) part[i].store_aligned(p + i * kPartLanes);
  }
  [[gnu::always_inline]] void store_unaligned(T* p) const {
    for (int i = 0; i < kParts; ++i) part[i].store_unaligned(p + i * kPartLanes);
  }

#define WINNOW_LANES_OPERATOR(op)                                                   \
  [[gnu::always_inline]] friend Lanes operator op(const Lanes& a, const Lanes& b) { \
    Lanes r;                                                                        \
    for (int i = 0; i < kParts; ++i) r.part[i] = a.part[i] op b.part[i];            \
    return r;                                                                       \
  }                                                                                 \
  [[gnu::always_inline]] Lanes& operator op##=(const Lanes& b) {                    \
    return *this = *this op b;                                                      \
  }
  WINNOW_LANES_OPERATOR(+)
  WINNOW_LANES_OPERATOR(-)
  WINNOW_LANES_OPERATOR(*)
  // Bitwise.
  WINNOW_LANES_OPERATOR(&)
  WINNOW_LANES_OPERATOR(|)
#undef WINNOW_LANES_OPERATOR
  [[gnu::always_inline]] friend Lanes operator/(const Lanes& a, const Lanes& b) {
    Lanes r;
    for (int i = 0; i < kParts; ++i) r.part[i] = quotient(a.part[i], b.part[i]);
    return r;
  }
  [[gnu::always_inline]] Lanes& operator/=(const Lanes& b) {
    return *this = *this / b;
  }
  [[gnu::always_inline]] friend Lanes operator-(const Lanes& a) {
    Lanes r;
    // xsimd's own negation of 0 depends on the instruction set.
    for (int i = 0; i < kParts; ++i) r.part[i] = Part(T(-0.0)) - a.part[i];
    return r;
  }

// False if either lane is NaN.
#define WINNOW_LANES_COMPARE(op)                                                   \
  [[gnu::always_inline]] friend Mask operator op(const Lanes& a, const Lanes& b) { \
    Mask r;                                                                        \
    for (int i = 0; i < kParts; ++i) r.part[i] = a.part[i] op b.part[i];           \
    return r;                                                                      \
  }
  WINNOW_LANES_COMPARE(<)
  WINNOW_LANES_COMPARE(<=)
  WINNOW_LANES_COMPARE(>)
  WINNOW_LANES_COMPARE(>=)
  WINNOW_LANES_COMPARE(==)
#undef WINNOW_LANES_COMPARE

  /// Returns a in the lanes of the mask, b in the others.
  [[gnu::always_inline]] friend Lanes select(const Mask& mask, const Lanes& a, const Lanes& b) {
    Lanes r;
    for (int i = 0; i < kParts; ++i) {
      r.part[i] = xsimd::select(mask.part[i], a.part[i], b.part[i]);
    }
    return r;
  }
  /// Lane-wise minimum and maximum; no lane may be NaN.
  [[gnu::always_inline]] friend Lanes min(const Lanes& a, const Lanes& b) {
    Lanes r;
    for (int i = 0; i < kParts; ++i) r.part[i] = xsimd::min(a.part[i], b.part[i]);
    return r;
  }
  [[gnu::always_inline]] friend Lanes max(const Lanes& a, const Lanes& b) {
    Lanes r;
    for (int i = 0; i < kParts; ++i) r.part[i] = xsimd::max(a.part[i], b.part[i]);
    return r;
  }
  [[gnu::always_inline]] friend Lanes abs(const Lanes& a) {
    Lanes r;
    for (int i = 0; i < kParts; ++i) r.part[i] = xsimd::abs(a.part[i]);
    return r;
  }
  [[gnu::always_inline]] friend Lanes sqrt(const Lanes& a) {
    Lanes r;
    for (int i = 0; i < kParts; ++i) r.part[i] = square_root(a.part[i]);
    return r;
  }
};

using Floats = Lanes<float>;
using Doubles = Lanes<double>;
using Uints = Lanes<std::uint32_t>;
using OneDouble = Lanes<double, 1>;

/// The largest finite number.
template <typename T>
inline constexpr T kLargest = sizeof(T) == sizeof(double) ? T(__DBL_MAX__) : T(__FLT_MAX__);

/// All lanes of Lanes<T>.
template <typename T>
inline constexpr Mask16 kAllLanes = (1U << Lanes<T>::kCount) - 1U;

#if defined(WINNOW_ISA_IS_avx512)

inline Mask16 bits(xsimd::batch_bool<float> b) {
  return static_cast<__mmask16>(static_cast<typename xsimd::batch_bool<float>::register_type>(b));
}

#elif defined(WINNOW_ISA_IS_avx2)

inline Mask16 bits(xsimd::batch_bool<float> b) {
  return static_cast<Mask16>(_mm256_movemask_ps(b));
}

#elif defined(WINNOW_ISA_IS_sse42)

inline Mask16 bits(xsimd::batch_bool<float> b) {
  return static_cast<Mask16>(_mm_movemask_ps(b));
}

#else

inline Mask16 bits(xsimd::batch_bool<float> b) {
  const uint32x4_t lane_bits = {1U, 2U, 4U, 8U};
  return vaddvq_u32(vandq_u32(static_cast<uint32x4_t>(b), lane_bits));
}

#endif

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

/// Converts to a mask, one bit per lane.
template <typename T, int Parts>
[[gnu::always_inline]] inline Mask16 bits(const LaneMask<T, Parts>& mask) {
  Mask16 r = 0;
  for (int i = 0; i < Parts; ++i) {
    r |= bits(mask.part[i]) << (i * Lanes<T>::kPartLanes);
  }
  return r;
}

/// Returns v in the lanes of the mask, infinity in the others.
[[gnu::always_inline]] inline Floats or_infinity(const LaneMask<float>& mask, const Floats& v) {
  return select(mask, v, Floats(__builtin_inff()));
}

/// Returns -1 in lanes below zero, 1 in the others.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> sign_or_one(const Lanes<T>& a) {
  return select(a < T(0), Lanes<T>(T(-1)), Lanes<T>(T(1)));
}

/// Computes a * b + c, rounded once or twice depending on the instruction set: only for bounds
/// whose callers allow for either.
inline Floats multiply_add(const Floats& a, const Floats& b, const Floats& c) {
  Floats r;
  for (int i = 0; i < Floats::kParts; ++i) {
#if defined(WINNOW_ISA_IS_avx512)
    r.part[i] = _mm512_fmadd_ps(a.part[i], b.part[i], c.part[i]);
#elif defined(WINNOW_ISA_IS_avx2)
    r.part[i] = _mm256_fmadd_ps(a.part[i], b.part[i], c.part[i]);
#elif defined(WINNOW_ISA_IS_neon64)
    r.part[i] = vfmaq_f32(c.part[i], a.part[i], b.part[i]);
#else
    r.part[i] = a.part[i] * b.part[i] + c.part[i];
#endif
  }
  return r;
}

/// Returns base, base + 1, ..., base + 15.
inline Uints count_from(std::uint32_t base) {
  alignas(64) static constexpr std::uint32_t kSteps[kLanes] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                               8, 9, 10, 11, 12, 13, 14, 15};
  Uints r;
  for (int i = 0; i < Uints::kParts; ++i) {
    r.part[i] = Uints::Part::load_aligned(kSteps + i * Uints::kPartLanes) + Uints::Part(base);
  }
  return r;
}
/// Returns the smallest lane; no lane may be NaN.
inline float reduce_min(const Floats& v) {
  Floats::Part m = v.part[0];
  for (int i = 1; i < Floats::kParts; ++i) m = xsimd::min(m, v.part[i]);
#if defined(WINNOW_ISA_IS_avx512)
  return _mm512_reduce_min_ps(m);
#elif defined(WINNOW_ISA_IS_neon64)
  return vminvq_f32(m);
#else
#if defined(WINNOW_ISA_IS_avx2)
  const __m256 w = m;
  __m128 x = _mm_min_ps(_mm256_castps256_ps128(w), _mm256_extractf128_ps(w, 1));
#else
  __m128 x = m;
#endif
  x = _mm_min_ps(x, _mm_movehl_ps(x, x));
  x = _mm_min_ss(x, _mm_movehdup_ps(x));
  return _mm_cvtss_f32(x);
#endif
}

/// Returns the largest lane; no lane may be NaN.
inline float reduce_max(const Floats& v) {
  Floats::Part m = v.part[0];
  for (int i = 1; i < Floats::kParts; ++i) m = xsimd::max(m, v.part[i]);
#if defined(WINNOW_ISA_IS_avx512)
  return _mm512_reduce_max_ps(m);
#elif defined(WINNOW_ISA_IS_neon64)
  return vmaxvq_f32(m);
#else
#if defined(WINNOW_ISA_IS_avx2)
  const __m256 w = m;
  __m128 x = _mm_max_ps(_mm256_castps256_ps128(w), _mm256_extractf128_ps(w, 1));
#else
  __m128 x = m;
#endif
  x = _mm_max_ps(x, _mm_movehl_ps(x, x));
  x = _mm_max_ss(x, _mm_movehdup_ps(x));
  return _mm_cvtss_f32(x);
#endif
}

/// Rounds eight lanes to the nearest floats, and writes them to the first parts of a Floats.
[[gnu::always_inline]] inline void round_to_single(const Doubles& v, Floats::Part* part) {
#if defined(WINNOW_ISA_IS_avx512)
  part[0] = _mm512_castps256_ps512(_mm512_cvtpd_ps(v.part[0]));
#elif defined(WINNOW_ISA_IS_avx2)
  part[0] = _mm256_set_m128(_mm256_cvtpd_ps(v.part[1]), _mm256_cvtpd_ps(v.part[0]));
#elif defined(WINNOW_ISA_IS_sse42)
  part[0] = _mm_movelh_ps(_mm_cvtpd_ps(v.part[0]), _mm_cvtpd_ps(v.part[1]));
  part[1] = _mm_movelh_ps(_mm_cvtpd_ps(v.part[2]), _mm_cvtpd_ps(v.part[3]));
#else
  part[0] = vcvt_high_f32_f64(vcvt_f32_f64(v.part[0]), v.part[1]);
  part[1] = vcvt_high_f32_f64(vcvt_f32_f64(v.part[2]), v.part[3]);
#endif
}

/// Rounds lanes to the nearest floats; `low` becomes lanes 0 to 7.
[[gnu::always_inline]] inline Floats to_single(const Doubles& low, const Doubles& high) {
  Floats r;
#if defined(WINNOW_ISA_IS_avx512)
  Floats::Part half[2];
  round_to_single(low, half);
  round_to_single(high, half + 1);
  r.part[0] = _mm512_insertf32x8(half[0], _mm512_castps512_ps256(half[1]), 1);
#else
  round_to_single(low, r.part);
  round_to_single(high, r.part + Floats::kParts / 2);
#endif
  return r;
}

/// As above, for eight lanes; lanes 8 to 15 are unspecified.
[[gnu::always_inline]] inline Floats to_single(const Doubles& v) {
#if defined(WINNOW_ISA_IS_avx512)
  Floats r;
  round_to_single(v, r.part);
  return r;
#else
  return to_single(v, v);
#endif
}
#if !defined(WINNOW_ISA_IS_avx512)
/// As above, for one register.
[[gnu::always_inline]] inline Lanes<float, 1> to_single(const OneDouble& v) {
  Lanes<float, 1> r;
#if defined(WINNOW_ISA_IS_avx2)
  r.part[0] = _mm256_castps128_ps256(_mm256_cvtpd_ps(v.part[0]));
#elif defined(WINNOW_ISA_IS_sse42)
  r.part[0] = _mm_cvtpd_ps(v.part[0]);
#else
  r.part[0] = vcombine_f32(vcvt_f32_f64(v.part[0]), vdup_n_f32(0.0F));
#endif
  return r;
}
#endif

/// Converts lanes 0 to 7 (Half = 0) or 8 to 15 (Half = 1) to double.
template <int Half>
[[gnu::always_inline]] inline Doubles to_double(const Floats& v) {
  Doubles r;
#if defined(WINNOW_ISA_IS_avx512)
  r.part[0] = _mm512_cvtps_pd(_mm512_extractf32x8_ps(v.part[0], Half));
#elif defined(WINNOW_ISA_IS_avx2)
  const __m256 half = v.part[Half];
  r.part[0] = _mm256_cvtps_pd(_mm256_castps256_ps128(half));
  r.part[1] = _mm256_cvtps_pd(_mm256_extractf128_ps(half, 1));
#else
  for (int i = 0; i < 2; ++i) {
    const auto quarter = v.part[2 * Half + i];
#if defined(WINNOW_ISA_IS_sse42)
    r.part[2 * i] = _mm_cvtps_pd(quarter);
    r.part[2 * i + 1] = _mm_cvtps_pd(_mm_movehl_ps(quarter, quarter));
#else
    r.part[2 * i] = vcvt_f64_f32(vget_low_f32(quarter));
    r.part[2 * i + 1] = vcvt_high_f64_f32(quarter);
#endif
  }
#endif
  return r;
}

}  // namespace winnow::WINNOW_ISA_NAME
