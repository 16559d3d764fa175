#pragma once

// Compaction of lanes by a mask, and interleaving of two lane values. The set lanes are packed to
// the front. Every store writes whole registers: the destination needs room for 16 elements from
// where it starts, whatever the mask. Queries and pair searches write their results with these
// functions.

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

#if defined(WINNOW_ISA_IS_avx2)

/// Source lane of each packed lane, for each mask of 8 lanes: 2 KB.
struct Permutations8 {
  std::uint8_t lane[256][8];
  constexpr Permutations8() : lane() {
    for (unsigned m = 0; m < 256; ++m) {
      unsigned n = 0;
      for (unsigned i = 0; i < 8; ++i) {
        if ((m >> i & 1U) != 0) lane[m][n++] = static_cast<std::uint8_t>(i);
      }
    }
  }
};
inline constexpr Permutations8 kPermutations8{};

inline __m256i pack8(__m256i v, unsigned m) {
  const __m128i narrow = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(kPermutations8.lane[m]));
  return _mm256_permutevar8x32_epi32(v, _mm256_cvtepu8_epi32(narrow));
}

#elif !defined(WINNOW_ISA_IS_avx512)

/// Byte shuffle that packs the set lanes, for each mask of 4 lanes.
struct Shuffles4 {
  alignas(16) std::uint8_t byte[16][16];
  constexpr Shuffles4() : byte() {
    for (unsigned m = 0; m < 16; ++m) {
      unsigned n = 0;
      for (unsigned i = 0; i < 4; ++i) {
        if ((m >> i & 1U) == 0) continue;
        for (unsigned b = 0; b < 4; ++b) byte[m][n++] = static_cast<std::uint8_t>(4 * i + b);
      }
    }
  }
};
inline constexpr Shuffles4 kShuffles4{};

inline Uints::Part pack4(Uints::Part v, unsigned m) {
#if defined(WINNOW_ISA_IS_neon64)
  return vreinterpretq_u32_u8(vqtbl1q_u8(vreinterpretq_u8_u32(v), vld1q_u8(kShuffles4.byte[m])));
#else
  return _mm_shuffle_epi8(v, _mm_load_si128(reinterpret_cast<const __m128i*>(kShuffles4.byte[m])));
#endif
}

/// Writes a0 b0 a1 b1 ... a3 b3.
inline void interleave4(Uints::Part a, Uints::Part b, std::uint32_t* out) {
#if defined(WINNOW_ISA_IS_neon64)
  vst1q_u32(out, vzip1q_u32(a, b));
  vst1q_u32(out + 4, vzip2q_u32(a, b));
#else
  auto* to = reinterpret_cast<__m128i*>(out);
  _mm_storeu_si128(to, _mm_unpacklo_epi32(a, b));
  _mm_storeu_si128(to + 1, _mm_unpackhi_epi32(a, b));
#endif
}

#endif

#if defined(WINNOW_ISA_IS_avx512)

/// Returns the set lanes of `v` in front, zeros behind them. The lanes are merged into a zero that
/// the compiler must create anew each time: on AMD's cores the zeroing form of the instruction
/// depends on the old value of its target, and loops would run at its latency.
inline __m512i pack16(Mask16 mask, __m512i v) {
  __m512i zero = _mm512_setzero_si512();
  asm("" : "+v"(zero));
  return _mm512_mask_compress_epi32(zero, static_cast<__mmask16>(mask), v);
}

#endif

/// Writes the set lanes of `v` to `out`, in order, and returns their number. Needs room for 16.
inline unsigned compress_store(Mask16 mask, const Uints& v, std::uint32_t* out) {
#if defined(WINNOW_ISA_IS_avx512)
  _mm512_storeu_si512(out, pack16(mask, v.part[0]));
#elif defined(WINNOW_ISA_IS_avx2)
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), pack8(v.part[0], mask & 0xFFU));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + count(mask & 0xFFU)),
                      pack8(v.part[1], mask >> 8U));
#else
  std::uint32_t* at = out;
  for (int i = 0; i < Uints::kParts; ++i) {
    const unsigned m = (mask >> (4 * i)) & 0xFU;
    pack4(v.part[i], m).store_unaligned(at);
    at += count(m);
  }
#endif
  return count(mask);
}

/// As above, for floats.
inline unsigned compress_store(Mask16 mask, const Floats& v, float* out) {
#if defined(WINNOW_ISA_IS_avx512)
  _mm512_storeu_si512(out, pack16(mask, _mm512_castps_si512(v.part[0])));
#elif defined(WINNOW_ISA_IS_avx2)
  const auto pack = [](__m256 part, unsigned m) {
    return _mm256_castsi256_ps(pack8(_mm256_castps_si256(part), m));
  };
  _mm256_storeu_ps(out, pack(v.part[0], mask & 0xFFU));
  _mm256_storeu_ps(out + count(mask & 0xFFU), pack(v.part[1], mask >> 8U));
#else
  float* at = out;
  for (int i = 0; i < Uints::kParts; ++i) {
    const unsigned m = (mask >> (4 * i)) & 0xFU;
#if defined(WINNOW_ISA_IS_neon64)
    vst1q_f32(at, vreinterpretq_f32_u32(pack4(vreinterpretq_u32_f32(v.part[i]), m)));
#else
    _mm_storeu_ps(at, _mm_castsi128_ps(pack4(_mm_castps_si128(v.part[i]), m)));
#endif
    at += count(m);
  }
#endif
  return count(mask);
}

/// Writes (q, lane) for the set lanes of `v` as consecutive pairs, and returns their number.
/// `Sorted` puts the smaller of the two first; otherwise q comes first. Needs room for 16 pairs.
template <bool Sorted>
inline unsigned emit_pairs(Mask16 mask, const Uints& v, std::uint32_t q, std::uint32_t* out) {
#if defined(WINNOW_ISA_IS_avx512)
  const __m512i packed = pack16(mask, v.part[0]);
  const __m512i query = _mm512_set1_epi32(static_cast<int>(q));
  const __m512i a = Sorted ? _mm512_min_epu32(query, packed) : query;
  const __m512i b = Sorted ? _mm512_max_epu32(query, packed) : packed;
  const __m512i low = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  _mm512_storeu_si512(out, _mm512_permutex2var_epi32(a, low, b));
  // Usually few lanes are set: skipping the second store saves more than rare mispredictions cost.
  if (__builtin_expect(count(mask) > 8, 0) != 0) {
    const __m512i high =
        _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
    _mm512_storeu_si512(out + 16, _mm512_permutex2var_epi32(a, high, b));
  }
#elif defined(WINNOW_ISA_IS_avx2)
  const __m256i query = _mm256_set1_epi32(static_cast<int>(q));
  std::uint32_t* at = out;
  for (int i = 0; i < Uints::kParts; ++i) {
    const unsigned m = (mask >> (8 * i)) & 0xFFU;
    const __m256i packed = pack8(v.part[i], m);
    const __m256i a = Sorted ? _mm256_min_epu32(query, packed) : query;
    const __m256i b = Sorted ? _mm256_max_epu32(query, packed) : packed;
    const __m256i even = _mm256_unpacklo_epi32(a, b);
    const __m256i odd = _mm256_unpackhi_epi32(a, b);
    auto* to = reinterpret_cast<__m256i*>(at);
    _mm256_storeu_si256(to, _mm256_permute2x128_si256(even, odd, 0x20));
    _mm256_storeu_si256(to + 1, _mm256_permute2x128_si256(even, odd, 0x31));
    at += 2 * count(m);
  }
#else
  std::uint32_t* at = out;
  for (int i = 0; i < Uints::kParts; ++i) {
    const unsigned m = (mask >> (4 * i)) & 0xFU;
    const Uints::Part packed = pack4(v.part[i], m);
    const Uints::Part query(q);
    const Uints::Part a = Sorted ? xsimd::min(query, packed) : query;
    const Uints::Part b = Sorted ? xsimd::max(query, packed) : packed;
    interleave4(a, b, at);
    at += 2 * count(m);
  }
#endif
  return count(mask);
}

/// Writes low + 2^32 high for the set lanes, which must be integers below 2^24. Needs room for 16.
[[gnu::always_inline]] inline void compress_words(Mask16 mask, const Floats& low,
                                                  const Floats& high, std::uint64_t* out) {
#if defined(WINNOW_ISA_IS_avx512)
  const auto pack = [mask](__m512 v) { return pack16(mask, _mm512_cvtps_epi32(v)); };
  const __m512i a = pack(high.part[0]);
  const __m512i b = pack(low.part[0]);
  const __m512i first_half =
      _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const __m512i last_half = _mm512_add_epi32(first_half, _mm512_set1_epi32(8));
  _mm512_storeu_si512(out, _mm512_permutex2var_epi32(b, first_half, a));
  _mm512_storeu_si512(out + 8, _mm512_permutex2var_epi32(b, last_half, a));
#else
  alignas(64) float a[kLanes];
  alignas(64) float b[kLanes];
  high.store_unaligned(a);
  low.store_unaligned(b);
  for (; mask != 0; mask &= mask - 1) {
    const unsigned lane = first(mask);
    *out++ = static_cast<std::uint64_t>(a[lane]) << 32U | static_cast<std::uint64_t>(b[lane]);
  }
#endif
}

/// Returns a0 b0 a1 b1 ... of eight lanes, from lane 0 or from lane 8.
template <int From>
[[gnu::always_inline]] inline Floats interleave(const Floats& a, const Floats& b) {
#if defined(WINNOW_ISA_IS_avx512)
  const __m512i order =
      _mm512_add_epi32(_mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23),
                       _mm512_set1_epi32(From));
  Floats r;
  r.part[0] = _mm512_permutex2var_ps(a.part[0], order, b.part[0]);
  return r;
#else
  alignas(64) float from[2][kLanes];
  alignas(64) float to[kLanes];
  a.store_unaligned(from[0]);
  b.store_unaligned(from[1]);
  for (int i = 0; i < kLanes; ++i) to[i] = from[i % 2][From + i / 2];
  return Floats::load(to);
#endif
}
/// As above, for the bits of two masks of eight lanes.
[[gnu::always_inline]] inline Mask16 interleave_bits(Mask16 a, Mask16 b) {
  const auto spread = [](Mask16 m) {
    m = (m | m << 4U) & 0x0F0FU;
    m = (m | m << 2U) & 0x3333U;
    return (m | m << 1U) & 0x5555U;
  };
  return spread(a & 0xFFU) | spread(b & 0xFFU) << 1U;
}

}  // namespace winnow::WINNOW_ISA_NAME
