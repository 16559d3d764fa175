#pragma once

// Minima and maxima of positive floats by integer instructions: the bits of positive floats have
// the order of the floats, and integer instructions have a lower latency.

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Lane-wise maximum; at least one of the two lanes must be positive, and no lane may be NaN.
[[gnu::always_inline]] inline Floats larger_positive(const Floats& a, const Floats& b) {
  Floats r;
  for (int i = 0; i < Floats::kParts; ++i) {
#if defined(WINNOW_ISA_IS_avx512)
    r.part[i] = _mm512_castsi512_ps(
        _mm512_max_epi32(_mm512_castps_si512(a.part[i]), _mm512_castps_si512(b.part[i])));
#elif defined(WINNOW_ISA_IS_avx2)
    r.part[i] = _mm256_castsi256_ps(
        _mm256_max_epi32(_mm256_castps_si256(a.part[i]), _mm256_castps_si256(b.part[i])));
#elif defined(WINNOW_ISA_IS_sse42)
    r.part[i] =
        _mm_castsi128_ps(_mm_max_epi32(_mm_castps_si128(a.part[i]), _mm_castps_si128(b.part[i])));
#else
    r.part[i] = vreinterpretq_f32_s32(
        vmaxq_s32(vreinterpretq_s32_f32(a.part[i]), vreinterpretq_s32_f32(b.part[i])));
#endif
  }
  return r;
}

/// Lane-wise minimum if both lanes are positive; otherwise one of the lanes that are not positive.
/// No lane may be NaN.
[[gnu::always_inline]] inline Floats smaller_positive(const Floats& a, const Floats& b) {
  Floats r;
  for (int i = 0; i < Floats::kParts; ++i) {
#if defined(WINNOW_ISA_IS_avx512)
    r.part[i] = _mm512_castsi512_ps(
        _mm512_min_epi32(_mm512_castps_si512(a.part[i]), _mm512_castps_si512(b.part[i])));
#elif defined(WINNOW_ISA_IS_avx2)
    r.part[i] = _mm256_castsi256_ps(
        _mm256_min_epi32(_mm256_castps_si256(a.part[i]), _mm256_castps_si256(b.part[i])));
#elif defined(WINNOW_ISA_IS_sse42)
    r.part[i] =
        _mm_castsi128_ps(_mm_min_epi32(_mm_castps_si128(a.part[i]), _mm_castps_si128(b.part[i])));
#else
    r.part[i] = vreinterpretq_f32_s32(
        vminq_s32(vreinterpretq_s32_f32(a.part[i]), vreinterpretq_s32_f32(b.part[i])));
#endif
  }
  return r;
}

/// Returns the bits of the smallest lane; all lanes must be positive.
[[gnu::always_inline]] inline std::uint32_t reduce_min_positive(const Floats& v) {
#if defined(WINNOW_ISA_IS_avx512)
  return static_cast<std::uint32_t>(_mm512_reduce_min_epi32(_mm512_castps_si512(v.part[0])));
#elif defined(WINNOW_ISA_IS_neon64)
  Floats::Part least = v.part[0];
  for (int i = 1; i < Floats::kParts; ++i) least = vminq_f32(least, v.part[i]);
  return __builtin_bit_cast(std::uint32_t, vminvq_f32(least));
#else
#if defined(WINNOW_ISA_IS_avx2)
  const __m256i both =
      _mm256_min_epi32(_mm256_castps_si256(v.part[0]), _mm256_castps_si256(v.part[1]));
  __m128i least = _mm_min_epi32(_mm256_castsi256_si128(both), _mm256_extracti128_si256(both, 1));
#else
  __m128i least =
      _mm_min_epi32(_mm_min_epi32(_mm_castps_si128(v.part[0]), _mm_castps_si128(v.part[1])),
                    _mm_min_epi32(_mm_castps_si128(v.part[2]), _mm_castps_si128(v.part[3])));
#endif
  least = _mm_min_epi32(least, _mm_shuffle_epi32(least, 0x4E));
  least = _mm_min_epi32(least, _mm_shuffle_epi32(least, 0xB1));
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(least));
#endif
}

}  // namespace winnow::WINNOW_ISA_NAME
