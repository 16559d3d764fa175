#pragma once

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Returns the lanes that have a bit in common with `bits`.
[[gnu::always_inline]] inline Mask16 test_bits(const Uints& v, std::uint32_t bits) {
#if defined(WINNOW_ISA_IS_avx512)
  return _mm512_test_epi32_mask(v.part[0], _mm512_set1_epi32(static_cast<int>(bits)));
#else
  Mask16 none = 0;
  for (int i = 0; i < Uints::kParts; ++i) {
    const int shift = i * Uints::kPartLanes;
#if defined(WINNOW_ISA_IS_avx2)
    const __m256i shared = _mm256_and_si256(v.part[i], _mm256_set1_epi32(static_cast<int>(bits)));
    const __m256i equal = _mm256_cmpeq_epi32(shared, _mm256_setzero_si256());
    none |= static_cast<Mask16>(_mm256_movemask_ps(_mm256_castsi256_ps(equal))) << shift;
#elif defined(WINNOW_ISA_IS_sse42)
    const __m128i shared = _mm_and_si128(v.part[i], _mm_set1_epi32(static_cast<int>(bits)));
    const __m128i equal = _mm_cmpeq_epi32(shared, _mm_setzero_si128());
    none |= static_cast<Mask16>(_mm_movemask_ps(_mm_castsi128_ps(equal))) << shift;
#else
    const uint32x4_t lane_bits = {1U, 2U, 4U, 8U};
    const uint32x4_t apart = vmvnq_u32(vtstq_u32(v.part[i], vdupq_n_u32(bits)));
    none |= static_cast<Mask16>(vaddvq_u32(vandq_u32(apart, lane_bits))) << shift;
#endif
  }
  return ~none & kAllRows;
#endif
}

}  // namespace winnow::WINNOW_ISA_NAME
