#pragma once

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Converts lanes within [0, 2^31) to integers, rounding toward 0.
[[gnu::always_inline]] inline Uints float_to_uint(const Floats& v) {
  Uints r;
  for (int i = 0; i < Floats::kParts; ++i) {
#if defined(WINNOW_ISA_IS_avx512)
    r.part[i] = _mm512_cvttps_epi32(v.part[i]);
#elif defined(WINNOW_ISA_IS_avx2)
    r.part[i] = _mm256_cvttps_epi32(v.part[i]);
#elif defined(WINNOW_ISA_IS_neon64)
    r.part[i] = vcvtq_u32_f32(v.part[i]);
#else
    r.part[i] = _mm_cvttps_epi32(v.part[i]);
#endif
  }
  return r;
}

}  // namespace winnow::WINNOW_ISA_NAME
