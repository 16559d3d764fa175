#pragma once

// Sixty-four bytes of one type of number as one value with operators: 16 floats, 16 unsigned or 8
// doubles on any instruction set, for kernel files only. One register on AVX-512, two on AVX2, four
// on SSE4.2 and NEON: since a block is 16 rows everywhere, kernels visit and report in the same
// order on every instruction set, and one template of a kernel serves both precisions. Every
// operation is rounded as IEEE 754 says and none is fused (but for multiply_add), so results are
// the same on every instruction set.
//
// The headers of this folder are the only ones that spell xsimd (8.1 to 14) and intrinsics. xsimd
// 8.1 has no bit mask of a batch_bool, no compress and no reduction by min or max: those are
// spelled here per instruction set.

#ifndef WINNOW_ISA_NAME
#error "lanes.h is for *.kernel.cpp files, which the build compiles once per instruction set"
#endif

#include <cstddef>
#include <cstdint>
#include <xsimd/xsimd.hpp>

namespace winnow::WINNOW_ISA_NAME {

/// Rows of a block, and lanes of float and unsigned.
inline constexpr int kLanes = 16;

/// One bit per lane; lane 0 is bit 0.
using Mask16 = std::uint32_t;

/// The lanes of a whole block.
inline constexpr Mask16 kAllRows = 0xFFFFU;

/// Number of set bits.
inline unsigned count(Mask16 mask) {
  return static_cast<unsigned>(__builtin_popcount(mask));
}
/// Index of the lowest set bit; `mask` is not 0.
inline unsigned first(Mask16 mask) {
  return static_cast<unsigned>(__builtin_ctz(mask));
}
/// The lowest n lanes, n <= 16.
inline constexpr Mask16 lanes_below(unsigned n) {
  return (1U << n) - 1U;
}

/// A truth value per lane of Lanes<T>, as registers hold them; `bits` makes a mask of it.
template <typename T>
struct LaneMask {
  using Part = xsimd::batch_bool<T>;
  static constexpr int kParts = static_cast<int>(64 / sizeof(T) / xsimd::batch<T>::size);

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

template <typename T>
struct Lanes {
  using Part = xsimd::batch<T>;
  static constexpr int kCount = static_cast<int>(64 / sizeof(T));
  static constexpr int kPartLanes = static_cast<int>(Part::size);
  static constexpr int kParts = kCount / kPartLanes;

  Part part[kParts];

  Lanes() = default;
  /// The same number in every lane.
  [[gnu::always_inline]] Lanes(T value) {  // NOLINT(google-explicit-constructor)
    for (int i = 0; i < kParts; ++i) part[i] = Part(value);
  }

  /// `p` is 64-byte aligned.
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
  /// `p` is 64-byte aligned.
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
  WINNOW_LANES_OPERATOR(/)
  // Of the bits that numbers are made of.
  WINNOW_LANES_OPERATOR(&)
  WINNOW_LANES_OPERATOR(|)
#undef WINNOW_LANES_OPERATOR
  [[gnu::always_inline]] friend Lanes operator-(const Lanes& a) {
    Lanes r;
    // What xsimd makes of -0.0 depends on the instruction set.
    for (int i = 0; i < kParts; ++i) r.part[i] = Part(T(-0.0)) - a.part[i];
    return r;
  }

// False where either is NaN.
#define WINNOW_LANES_COMPARE(op)                                                          \
  [[gnu::always_inline]] friend LaneMask<T> operator op(const Lanes& a, const Lanes& b) { \
    LaneMask<T> r;                                                                        \
    for (int i = 0; i < kParts; ++i) r.part[i] = a.part[i] op b.part[i];                  \
    return r;                                                                             \
  }
  WINNOW_LANES_COMPARE(<)
  WINNOW_LANES_COMPARE(<=)
  WINNOW_LANES_COMPARE(>)
  WINNOW_LANES_COMPARE(>=)
  WINNOW_LANES_COMPARE(==)
#undef WINNOW_LANES_COMPARE

  /// a where the mask holds, b elsewhere.
  [[gnu::always_inline]] friend Lanes select(const LaneMask<T>& mask, const Lanes& a,
                                             const Lanes& b) {
    Lanes r;
    for (int i = 0; i < kParts; ++i) {
      r.part[i] = xsimd::select(mask.part[i], a.part[i], b.part[i]);
    }
    return r;
  }
  /// Lane-wise smaller and larger; no lane may be NaN.
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
    for (int i = 0; i < kParts; ++i) r.part[i] = xsimd::sqrt(a.part[i]);
    return r;
  }
};

using Floats = Lanes<float>;
using Doubles = Lanes<double>;
using Uints = Lanes<std::uint32_t>;

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

/// A mask of the lanes that hold.
template <typename T>
[[gnu::always_inline]] inline Mask16 bits(const LaneMask<T>& mask) {
  Mask16 r = 0;
  for (int i = 0; i < LaneMask<T>::kParts; ++i) {
    r |= bits(mask.part[i]) << (i * Lanes<T>::kPartLanes);
  }
  return r;
}

/// v where the mask holds, infinity elsewhere.
[[gnu::always_inline]] inline Floats or_infinity(const LaneMask<float>& mask, const Floats& v) {
  return select(mask, v, Floats(__builtin_inff()));
}

/// -1 where a is below zero, 1 elsewhere.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> sign_or_one(const Lanes<T>& a) {
  return select(a < T(0), Lanes<T>(T(-1)), Lanes<T>(T(1)));
}

/// a * b + c, rounded once or twice as the instruction set has it: for bounds alone, whose callers
/// allow for either.
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

/// base, base + 1, ..., base + 15.
inline Uints count_from(std::uint32_t base) {
  alignas(64) static constexpr std::uint32_t kSteps[kLanes] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                               8, 9, 10, 11, 12, 13, 14, 15};
  Uints r;
  for (int i = 0; i < Uints::kParts; ++i) {
    r.part[i] = Uints::Part::load_aligned(kSteps + i * Uints::kPartLanes) + Uints::Part(base);
  }
  return r;
}
/// Smallest lane; no NaN.
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

/// Largest lane; no NaN.
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

/// Lanes rounded to the nearest float: `low` becomes lanes 0 to 7.
[[gnu::always_inline]] inline Floats to_single(const Doubles& low, const Doubles& high) {
  Floats r;
#if defined(WINNOW_ISA_IS_avx512)
  r.part[0] = _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(low.part[0])),
                                 _mm512_cvtpd_ps(high.part[0]), 1);
#elif defined(WINNOW_ISA_IS_avx2)
  r.part[0] = _mm256_set_m128(_mm256_cvtpd_ps(low.part[1]), _mm256_cvtpd_ps(low.part[0]));
  r.part[1] = _mm256_set_m128(_mm256_cvtpd_ps(high.part[1]), _mm256_cvtpd_ps(high.part[0]));
#else
  alignas(64) double from[kLanes];
  alignas(64) float to[kLanes];
  low.store(from);
  high.store(from + 8);
  for (int lane = 0; lane < kLanes; ++lane) to[lane] = static_cast<float>(from[lane]);
  r = Floats::load(to);
#endif
  return r;
}

/// The same of eight lanes; lanes 8 to 15 are unspecified.
[[gnu::always_inline]] inline Floats to_single(const Doubles& v) {
#if defined(WINNOW_ISA_IS_avx512)
  Floats r;
  r.part[0] = _mm512_castps256_ps512(_mm512_cvtpd_ps(v.part[0]));
  return r;
#else
  return to_single(v, v);
#endif
}

/// Lanes 0 to 7, or 8 to 15, in double.
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
  alignas(64) float from[kLanes];
  alignas(64) double to[8];
  v.store(from);
  for (int lane = 0; lane < 8; ++lane) to[lane] = static_cast<double>(from[Half * 8 + lane]);
  r = Doubles::load(to);
#endif
  return r;
}

}  // namespace winnow::WINNOW_ISA_NAME
