#pragma once

// Lanes from elsewhere than from sixteen neighbours of their type: by index, and from 16 bits.

#include "simd/lanes/rows.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// Sixteen numbers of 16 bits as floats, which hold them exactly.
[[gnu::always_inline]] inline Single16 load_short(const std::uint16_t* p) {
  Single16 r;
#if defined(WINNOW_ISA_IS_avx512)
  r.part[0] = _mm512_cvtepi32_ps(
      _mm512_cvtepu16_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))));
#elif defined(WINNOW_ISA_IS_avx2)
  for (int i = 0; i < 2; ++i) {
    const __m128i narrow = _mm_loadu_si128(reinterpret_cast<const __m128i*>(p + 8 * i));
    r.part[i] = _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(narrow));
  }
#elif defined(WINNOW_ISA_IS_sse42)
  for (int i = 0; i < 4; ++i) {
    const __m128i narrow = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(p + 4 * i));
    r.part[i] = _mm_cvtepi32_ps(_mm_cvtepu16_epi32(narrow));
  }
#else
  for (int i = 0; i < 4; ++i) r.part[i] = vcvtq_f32_u32(vmovl_u16(vld1_u16(p + 4 * i)));
#endif
  return r;
}

/// Lane l is base[index[l]]; indices are below 2^31.
[[gnu::always_inline]] inline Single16 gather(const float* base, const std::uint32_t* index) {
  Single16 r;
#if defined(WINNOW_ISA_IS_avx512)
  r.part[0] = _mm512_i32gather_ps(_mm512_loadu_si512(index), base, 4);
#elif defined(WINNOW_ISA_IS_avx2)
  for (int i = 0; i < 2; ++i) {
    const __m256i at = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(index + 8 * i));
    r.part[i] = _mm256_i32gather_ps(base, at, 4);
  }
#else
  for (int i = 0; i < 4; ++i) {
    const std::uint32_t* at = index + 4 * i;
    alignas(16) const float lane[4] = {base[at[0]], base[at[1]], base[at[2]], base[at[3]]};
    r.part[i] = Single16::Batch::load_aligned(lane);
  }
#endif
  return r;
}

/// The same lanes, as comparisons take them.
[[gnu::always_inline]] inline Float16 lanes_of(const Single16& v) {
  Float16 r;
  for (int i = 0; i < kParts; ++i) r.part[i] = v.part[i];
  return r;
}
[[gnu::always_inline]] inline Single16 real_of(const Float16& v) {
  Single16 r;
  for (int i = 0; i < kParts; ++i) r.part[i] = v.part[i];
  return r;
}

}  // namespace winnow::WINNOW_ISA_NAME
