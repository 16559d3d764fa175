#pragma once

// One triangle in lanes: one number per corner, in order, and the number of the first corner again.

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Lanes 0 to 3 belong to corners 0, 1, 2 and 0; other lanes are zero.
using CornerDoubles = Lanes<double, (4 + OneDouble::kPartLanes - 1) / OneDouble::kPartLanes>;
inline constexpr Mask16 kThreeCorners = 7U;

/// Loads x, y and z of three points as doubles. Also reads one float behind each point.
[[gnu::always_inline]] inline void load_points(const float* a, const float* b, const float* c,
                                               CornerDoubles (&point)[3]) {
#if defined(WINNOW_ISA_IS_neon64)
  const float* const corner[4] = {a, b, c, a};
  alignas(64) double stage[3][4];
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 4; ++k) stage[axis][k] = static_cast<double>(corner[k][axis]);
    point[axis] = CornerDoubles::load(stage[axis]);
  }
#else
  const __m128 first = _mm_loadu_ps(a);
  const __m128 third = _mm_loadu_ps(c);
  const __m128 second = _mm_loadu_ps(b);
  const __m128 low = _mm_unpacklo_ps(first, second);
  const __m128 next_low = _mm_unpacklo_ps(third, first);
  const __m128 axis[3] = {
      _mm_movelh_ps(low, next_low), _mm_movehl_ps(next_low, low),
      _mm_movelh_ps(_mm_unpackhi_ps(first, second), _mm_unpackhi_ps(third, first))};
  for (int k = 0; k < 3; ++k) {
#if defined(WINNOW_ISA_IS_avx512)
    point[k].part[0] = _mm512_zextpd256_pd512(_mm256_cvtps_pd(axis[k]));
#elif defined(WINNOW_ISA_IS_avx2)
    point[k].part[0] = _mm256_cvtps_pd(axis[k]);
#else
    point[k].part[0] = _mm_cvtps_pd(axis[k]);
    point[k].part[1] = _mm_cvtps_pd(_mm_movehl_ps(axis[k], axis[k]));
#endif
  }
#endif
}

/// Returns three numbers, one per corner, as lanes.
[[gnu::always_inline]] inline CornerDoubles join_corners(double a, double b, double c) {
  alignas(64) const double corner[CornerDoubles::kCount] = {a, b, c, a};
  return CornerDoubles::load(corner);
}

/// Moves the number of each corner to the corner before it.
[[gnu::always_inline]] inline CornerDoubles of_next(const CornerDoubles& v) {
  CornerDoubles r;
#if defined(WINNOW_ISA_IS_avx512)
  r.part[0] = _mm512_permutex_pd(v.part[0], 0x49);
#elif defined(WINNOW_ISA_IS_avx2)
  r.part[0] = _mm256_permute4x64_pd(v.part[0], 0x49);
#elif defined(WINNOW_ISA_IS_sse42)
  r.part[0] = _mm_shuffle_pd(v.part[0], v.part[1], 1);
  r.part[1] = v.part[0];
#else
  r.part[0] = vextq_f64(v.part[0], v.part[1], 1);
  r.part[1] = v.part[0];
#endif
  return r;
}

}  // namespace winnow::WINNOW_ISA_NAME
