#pragma once

// One vector of three dimensions in lanes, where there are not enough vectors to fill them.

#include "simd/lanes/corners.h"

namespace winnow::WINNOW_ISA_NAME {

/// Lanes 0 to 2 are the axes; others are zero where they are loaded.
using Axes = CornerDoubles;

/// Four numbers may be read.
[[gnu::always_inline]] inline Axes load_axes(const double* p) {
  Axes r;
#if defined(WINNOW_ISA_IS_avx512)
  r.part[0] = _mm512_zextpd256_pd512(_mm256_blend_pd(_mm256_loadu_pd(p), _mm256_setzero_pd(), 8));
#elif defined(WINNOW_ISA_IS_avx2)
  r.part[0] = _mm256_blend_pd(_mm256_loadu_pd(p), _mm256_setzero_pd(), 8);
#elif defined(WINNOW_ISA_IS_sse42)
  r.part[0] = _mm_loadu_pd(p);
  r.part[1] = _mm_load_sd(p + 2);
#else
  r.part[0] = vld1q_f64(p);
  r.part[1] = vcombine_f64(vld1_f64(p + 2), vdup_n_f64(0.0));
#endif
  return r;
}
/// The same in double; four numbers may be read, the last of which need not be zero.
[[gnu::always_inline]] inline Axes load_axes(const float* p) {
  Axes r;
#if defined(WINNOW_ISA_IS_avx512)
  r.part[0] = _mm512_zextpd256_pd512(_mm256_cvtps_pd(_mm_loadu_ps(p)));
#elif defined(WINNOW_ISA_IS_avx2)
  r.part[0] = _mm256_cvtps_pd(_mm_loadu_ps(p));
#elif defined(WINNOW_ISA_IS_sse42)
  const __m128 single = _mm_loadu_ps(p);
  r.part[0] = _mm_cvtps_pd(single);
  r.part[1] = _mm_cvtps_pd(_mm_movehl_ps(single, single));
#else
  const float32x4_t single = vld1q_f32(p);
  r.part[0] = vcvt_f64_f32(vget_low_f32(single));
  r.part[1] = vcvt_high_f64_f32(single);
#endif
  return r;
}
/// Of three numbers by themselves; if they were stored just now, a load of all would have to wait
/// until they are in memory.
[[gnu::always_inline]] inline Axes join_axes(double x, double y, double z) {
  Axes r;
#if defined(WINNOW_ISA_IS_neon64)
  r.part[0] = vcombine_f64(vdup_n_f64(x), vdup_n_f64(y));
  r.part[1] = vcombine_f64(vdup_n_f64(z), vdup_n_f64(0.0));
#else
  const __m128d low = _mm_set_pd(y, x);
  const __m128d high = _mm_set_sd(z);
#if defined(WINNOW_ISA_IS_avx512)
  r.part[0] = _mm512_zextpd256_pd512(_mm256_set_m128d(high, low));
#elif defined(WINNOW_ISA_IS_avx2)
  r.part[0] = _mm256_set_m128d(high, low);
#else
  r.part[0] = low;
  r.part[1] = high;
#endif
#endif
  return r;
}
/// Four numbers are written.
[[gnu::always_inline]] inline void store_axes(const Axes& v, double* p) {
#if defined(WINNOW_ISA_IS_avx512)
  _mm256_storeu_pd(p, _mm512_castpd512_pd256(v.part[0]));
#else
  v.store_unaligned(p);
#endif
}
/// The same, rounded to the nearest float.
[[gnu::always_inline]] inline void store_axes(const Axes& v, float* p) {
#if defined(WINNOW_ISA_IS_avx512)
  _mm_storeu_ps(p, _mm256_cvtpd_ps(_mm512_castpd512_pd256(v.part[0])));
#elif defined(WINNOW_ISA_IS_avx2)
  _mm_storeu_ps(p, _mm256_cvtpd_ps(v.part[0]));
#elif defined(WINNOW_ISA_IS_sse42)
  _mm_storeu_ps(p, _mm_movelh_ps(_mm_cvtpd_ps(v.part[0]), _mm_cvtpd_ps(v.part[1])));
#else
  vst1q_f32(p, vcvt_high_f32_f64(vcvt_f32_f64(v.part[0]), v.part[1]));
#endif
}

}  // namespace winnow::WINNOW_ISA_NAME
