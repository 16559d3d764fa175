#pragma once

// Points of which each takes four bytes: ten bits for each coordinate, the first one's the lowest.

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Coordinates of sixteen points; `p` is 64-byte aligned.
[[gnu::always_inline]] inline void load_packed(const std::uint32_t* p, Floats (&axis)[3]) {
#if defined(WINNOW_ISA_IS_avx512)
  const __m512i all = _mm512_load_si512(p);
  const __m512i low = _mm512_set1_epi32(1023);
  axis[0].part[0] = _mm512_cvtepi32_ps(_mm512_and_si512(all, low));
  axis[1].part[0] = _mm512_cvtepi32_ps(_mm512_and_si512(_mm512_srli_epi32(all, 10), low));
  axis[2].part[0] = _mm512_cvtepi32_ps(_mm512_srli_epi32(all, 20));
#elif defined(WINNOW_ISA_IS_avx2)
  const __m256i low = _mm256_set1_epi32(1023);
  for (int i = 0; i < 2; ++i) {
    const __m256i all = _mm256_load_si256(reinterpret_cast<const __m256i*>(p + 8 * i));
    axis[0].part[i] = _mm256_cvtepi32_ps(_mm256_and_si256(all, low));
    axis[1].part[i] = _mm256_cvtepi32_ps(_mm256_and_si256(_mm256_srli_epi32(all, 10), low));
    axis[2].part[i] = _mm256_cvtepi32_ps(_mm256_srli_epi32(all, 20));
  }
#elif defined(WINNOW_ISA_IS_sse42)
  const __m128i low = _mm_set1_epi32(1023);
  for (int i = 0; i < 4; ++i) {
    const __m128i all = _mm_load_si128(reinterpret_cast<const __m128i*>(p + 4 * i));
    axis[0].part[i] = _mm_cvtepi32_ps(_mm_and_si128(all, low));
    axis[1].part[i] = _mm_cvtepi32_ps(_mm_and_si128(_mm_srli_epi32(all, 10), low));
    axis[2].part[i] = _mm_cvtepi32_ps(_mm_srli_epi32(all, 20));
  }
#else
  const uint32x4_t low = vdupq_n_u32(1023U);
  for (int i = 0; i < 4; ++i) {
    const uint32x4_t all = vld1q_u32(p + 4 * i);
    axis[0].part[i] = vcvtq_f32_u32(vandq_u32(all, low));
    axis[1].part[i] = vcvtq_f32_u32(vandq_u32(vshrq_n_u32(all, 10), low));
    axis[2].part[i] = vcvtq_f32_u32(vshrq_n_u32(all, 20));
  }
#endif
}

}  // namespace winnow::WINNOW_ISA_NAME
