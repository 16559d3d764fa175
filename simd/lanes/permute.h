#pragma once

// Permutation of lanes: selects sixteen lanes from 16 or 32 others by indices of a byte each.

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Sixteen lane indices, each below 16, or below 32 for a selection from two blocks.
class LanePermutation {
 public:
  [[gnu::always_inline]] explicit LanePermutation(const std::uint8_t* p) {
#if defined(WINNOW_ISA_IS_avx512)
    place_ = _mm512_cvtepu8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(p)));
#elif defined(WINNOW_ISA_IS_avx2)
    for (int i = 0; i < 2; ++i) {
      place_[i] =
          _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p + 8 * i)));
    }
#else
    place_ = p;
#endif
  }

  /// Returns lanes in which lane i is lane p[i] of `from`.
  [[nodiscard, gnu::always_inline]] Floats pick(const Floats (&from)[1]) const {
#if defined(WINNOW_ISA_IS_avx512)
    Floats r;
    r.part[0] = _mm512_permutexvar_ps(place_, from[0].part[0]);
    return r;
#elif defined(WINNOW_ISA_IS_avx2)
    return pick_any(from[0]);
#else
    return pick_staged(from);
#endif
  }
  /// As above; an index i of 16 or more selects lane i - 16 of from[1].
  [[nodiscard, gnu::always_inline]] Floats pick(const Floats (&from)[2]) const {
#if defined(WINNOW_ISA_IS_avx512)
    Floats r;
    r.part[0] = _mm512_permutex2var_ps(from[0].part[0], place_, from[1].part[0]);
    return r;
#elif defined(WINNOW_ISA_IS_avx2)
    const Floats low = pick_any(from[0]);
    const Floats high = pick_any(from[1]);
    Floats r;
    for (int i = 0; i < 2; ++i) r.part[i] = by_bit<4>(i, low.part[i], high.part[i]);
    return r;
#else
    return pick_staged(from);
#endif
  }

 private:
#if defined(WINNOW_ISA_IS_avx512)
  __m512i place_;
#elif defined(WINNOW_ISA_IS_avx2)
  /// Returns `set` in lanes whose index has this bit, `clear` in the others.
  template <int Bit>
  [[nodiscard, gnu::always_inline]] __m256 by_bit(int i, __m256 clear, __m256 set) const {
    return _mm256_blendv_ps(clear, set,
                            _mm256_castsi256_ps(_mm256_slli_epi32(place_[i], 31 - Bit)));
  }
  /// Selects by the lowest four bits of each index.
  [[nodiscard, gnu::always_inline]] Floats pick_any(const Floats& from) const {
    Floats r;
    for (int i = 0; i < 2; ++i) {
      r.part[i] = by_bit<3>(i, _mm256_permutevar8x32_ps(from.part[0], place_[i]),
                            _mm256_permutevar8x32_ps(from.part[1], place_[i]));
    }
    return r;
  }

  __m256i place_[2];
#else
  template <int Blocks>
  [[nodiscard, gnu::always_inline]] Floats pick_staged(const Floats (&from)[Blocks]) const {
    alignas(64) float lane[Blocks * kLanes];
    alignas(64) float picked[kLanes];
    for (int k = 0; k < Blocks; ++k) from[k].store(lane + k * kLanes);
    for (int i = 0; i < kLanes; ++i) picked[i] = lane[place_[i]];
    return Floats::load(picked);
  }

  const std::uint8_t* place_;
#endif
};

/// Returns true if all of 48 numbers are below `Limit`, a power of two.
template <unsigned Limit>
[[gnu::always_inline]] inline bool are_below(const std::uint8_t* p) {
#if defined(WINNOW_ISA_IS_neon64)
  const uint8x16_t all = vorrq_u8(vorrq_u8(vld1q_u8(p), vld1q_u8(p + 16)), vld1q_u8(p + 32));
  return vmaxvq_u8(all) < Limit;
#else
  const auto load = [&](int i) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p + 16 * i));
  };
  const __m128i all = _mm_or_si128(_mm_or_si128(load(0), load(1)), load(2));
  return _mm_testz_si128(all, _mm_set1_epi8(static_cast<char>(256U - Limit))) != 0;
#endif
}

}  // namespace winnow::WINNOW_ISA_NAME
