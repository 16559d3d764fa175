#pragma once

// Points of four bytes each: ten bits per coordinate, x in the lowest ten.

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Returns coordinate `axis` of sixteen points; `p` must be 64-byte aligned.
[[gnu::always_inline]] inline Floats load_packed(const std::uint32_t* p, std::uint32_t axis) {
  const auto shift = static_cast<int>(10U * axis);
  Floats r;
#if defined(WINNOW_ISA_IS_avx512)
  const __m512i all = _mm512_srlv_epi32(_mm512_load_si512(p), _mm512_set1_epi32(shift));
  r.part[0] = _mm512_cvtepi32_ps(_mm512_and_si512(all, _mm512_set1_epi32(1023)));
#elif defined(WINNOW_ISA_IS_avx2)
  for (int i = 0; i < 2; ++i) {
    const __m256i all = _mm256_load_si256(reinterpret_cast<const __m256i*>(p + 8 * i));
    r.part[i] = _mm256_cvtepi32_ps(_mm256_and_si256(
        _mm256_srlv_epi32(all, _mm256_set1_epi32(shift)), _mm256_set1_epi32(1023)));
  }
#elif defined(WINNOW_ISA_IS_sse42)
  for (int i = 0; i < 4; ++i) {
    const __m128i all = _mm_load_si128(reinterpret_cast<const __m128i*>(p + 4 * i));
    r.part[i] = _mm_cvtepi32_ps(
        _mm_and_si128(_mm_srl_epi32(all, _mm_cvtsi32_si128(shift)), _mm_set1_epi32(1023)));
  }
#else
  for (int i = 0; i < 4; ++i) {
    const uint32x4_t all = vshlq_u32(vld1q_u32(p + 4 * i), vdupq_n_s32(-shift));
    r.part[i] = vcvtq_f32_u32(vandq_u32(all, vdupq_n_u32(1023U)));
  }
#endif
  return r;
}

}  // namespace winnow::WINNOW_ISA_NAME
