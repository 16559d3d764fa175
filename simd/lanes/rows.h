#pragma once

// Loads of lanes that are not contiguous numbers of their type in memory: numbers of 16 bits, and
// rows of doubles at separate addresses; also sixteen reductions at once. On AVX-512, and for rows
// of four doubles on AVX2, rows are loaded whole and transposed in registers. This avoids gather
// instructions, and vector loads of numbers that were just stored one by one, which stall on store
// forwarding.

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Loads sixteen numbers of 16 bits as floats, which represent them exactly.
[[gnu::always_inline]] inline Floats load_short(const std::uint16_t* p) {
  Floats r;
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

#if defined(WINNOW_ISA_IS_avx512)

/// Reduces 256 floats to 16 lanes: lane i of the result is the smallest (largest) of floats [16 i,
/// 16 i + 16). `p` must be 64-byte aligned. The method is a transposition that halves the data by
/// min (max) at every step, which takes fewer instructions than sixteen reductions.
template <typename Pick>
inline Floats reduce_rows(const float* p, Pick&& pick) {
  __m512 quad[4];
  for (int k = 0; k < 4; ++k) {
    const float* q = p + k * 4 * kLanes;
    const __m512 a = _mm512_load_ps(q);
    const __m512 b = _mm512_load_ps(q + 16);
    const __m512 c = _mm512_load_ps(q + 32);
    const __m512 d = _mm512_load_ps(q + 48);
    const __m512 ab = pick(_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
    const __m512 cd = pick(_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
    quad[k] = pick(_mm512_shuffle_ps(ab, cd, 0x44), _mm512_shuffle_ps(ab, cd, 0xEE));
  }
  const __m512 low = pick(_mm512_shuffle_f32x4(quad[0], quad[1], 0x88),
                          _mm512_shuffle_f32x4(quad[0], quad[1], 0xDD));
  const __m512 high = pick(_mm512_shuffle_f32x4(quad[2], quad[3], 0x88),
                           _mm512_shuffle_f32x4(quad[2], quad[3], 0xDD));
  Floats r;
  r.part[0] = pick(_mm512_shuffle_f32x4(low, high, 0x88), _mm512_shuffle_f32x4(low, high, 0xDD));
  return r;
}
inline Floats reduce_min_rows(const float* p) {
  return reduce_rows(p, [](__m512 a, __m512 b) { return _mm512_min_ps(a, b); });
}
inline Floats reduce_max_rows(const float* p) {
  return reduce_rows(p, [](__m512 a, __m512 b) { return _mm512_max_ps(a, b); });
}

#elif defined(WINNOW_ISA_IS_avx2)

template <typename Pick>
inline Floats reduce_rows(const float* p, Pick&& pick) {
  Floats r;
  for (int half = 0; half < 2; ++half) {
    __m256 quad[2];
    for (int k = 0; k < 2; ++k) {
      const float* q = p + (half * 8 + k * 4) * kLanes;
      __m256 row[4];
      for (int i = 0; i < 4; ++i) {
        row[i] = pick(_mm256_load_ps(q + i * kLanes), _mm256_load_ps(q + i * kLanes + 8));
      }
      const __m256 ab =
          pick(_mm256_unpacklo_ps(row[0], row[1]), _mm256_unpackhi_ps(row[0], row[1]));
      const __m256 cd =
          pick(_mm256_unpacklo_ps(row[2], row[3]), _mm256_unpackhi_ps(row[2], row[3]));
      quad[k] = pick(_mm256_shuffle_ps(ab, cd, 0x44), _mm256_shuffle_ps(ab, cd, 0xEE));
    }
    r.part[half] = pick(_mm256_permute2f128_ps(quad[0], quad[1], 0x20),
                        _mm256_permute2f128_ps(quad[0], quad[1], 0x31));
  }
  return r;
}
inline Floats reduce_min_rows(const float* p) {
  return reduce_rows(p, [](__m256 a, __m256 b) { return _mm256_min_ps(a, b); });
}
inline Floats reduce_max_rows(const float* p) {
  return reduce_rows(p, [](__m256 a, __m256 b) { return _mm256_max_ps(a, b); });
}

#else

inline Floats reduce_min_rows(const float* p) {
  alignas(64) float lane[kLanes];
  for (int i = 0; i < kLanes; ++i) lane[i] = reduce_min(Floats::load(p + i * kLanes));
  return Floats::load(lane);
}
inline Floats reduce_max_rows(const float* p) {
  alignas(64) float lane[kLanes];
  for (int i = 0; i < kLanes; ++i) lane[i] = reduce_max(Floats::load(p + i * kLanes));
  return Floats::load(lane);
}

#endif

#if defined(WINNOW_ISA_IS_avx512)

[[gnu::always_inline]] inline __m512d two_rows(const double* low, const double* high) {
  return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(low)), _mm256_loadu_pd(high), 1);
}
/// row[i] contains two of eight rows: 0 and 2, 1 and 3, 4 and 6, 5 and 7.
[[gnu::always_inline]] inline void transpose_rows(const __m512d (&row)[4], Doubles (&out)[4]) {
  const __m512d even_low = _mm512_unpacklo_pd(row[0], row[1]);
  const __m512d even_high = _mm512_unpacklo_pd(row[2], row[3]);
  const __m512d odd_low = _mm512_unpackhi_pd(row[0], row[1]);
  const __m512d odd_high = _mm512_unpackhi_pd(row[2], row[3]);
  out[0].part[0] = _mm512_shuffle_f64x2(even_low, even_high, 0x88);
  out[1].part[0] = _mm512_shuffle_f64x2(odd_low, odd_high, 0x88);
  out[2].part[0] = _mm512_shuffle_f64x2(even_low, even_high, 0xDD);
  out[3].part[0] = _mm512_shuffle_f64x2(odd_low, odd_high, 0xDD);
}
inline constexpr int kRowOrder[4] = {0, 1, 4, 5};

#elif defined(WINNOW_ISA_IS_avx2)

[[gnu::always_inline]] inline void transpose_rows(const __m256d (&row)[4], int part,
                                                  Doubles (&out)[4]) {
  const __m256d even_low = _mm256_unpacklo_pd(row[0], row[1]);
  const __m256d even_high = _mm256_unpacklo_pd(row[2], row[3]);
  const __m256d odd_low = _mm256_unpackhi_pd(row[0], row[1]);
  const __m256d odd_high = _mm256_unpackhi_pd(row[2], row[3]);
  out[0].part[part] = _mm256_permute2f128_pd(even_low, even_high, 0x20);
  out[1].part[part] = _mm256_permute2f128_pd(odd_low, odd_high, 0x20);
  out[2].part[part] = _mm256_permute2f128_pd(even_low, even_high, 0x31);
  out[3].part[part] = _mm256_permute2f128_pd(odd_low, odd_high, 0x31);
}

#endif

/// Loads row(l)[k] into lane l of out[k], for k < 4.
template <typename Row>
[[gnu::always_inline]] inline void load_rows4(Row&& row, Doubles (&out)[4]) {
#if defined(WINNOW_ISA_IS_avx512)
  __m512d rows[4];
  for (int i = 0; i < 4; ++i) rows[i] = two_rows(row(kRowOrder[i]), row(kRowOrder[i] + 2));
  transpose_rows(rows, out);
#elif defined(WINNOW_ISA_IS_avx2)
  for (int part = 0; part < 2; ++part) {
    __m256d rows[4];
    for (int i = 0; i < 4; ++i) rows[i] = _mm256_loadu_pd(row(part * 4 + i));
    transpose_rows(rows, part, out);
  }
#else
  alignas(64) double stage[4][8];
  for (int lane = 0; lane < 8; ++lane) {
    const double* p = row(lane);
    for (int k = 0; k < 4; ++k) stage[k][lane] = p[k];
  }
  for (int k = 0; k < 4; ++k) out[k] = Doubles::load(stage[k]);
#endif
}

/// Computes row(l)[k] - base(l)[k] in lane l of out[k], for k < 4.
template <typename Row, typename Base>
[[gnu::always_inline]] inline void load_differences4(Row&& row, Base&& base, Doubles (&out)[4]) {
#if defined(WINNOW_ISA_IS_avx512)
  __m512d rows[4];
  for (int i = 0; i < 4; ++i) {
    const int lane = kRowOrder[i];
    rows[i] =
        _mm512_sub_pd(two_rows(row(lane), row(lane + 2)), two_rows(base(lane), base(lane + 2)));
  }
  transpose_rows(rows, out);
#elif defined(WINNOW_ISA_IS_avx2)
  for (int part = 0; part < 2; ++part) {
    __m256d rows[4];
    for (int i = 0; i < 4; ++i) {
      const int lane = part * 4 + i;
      rows[i] = _mm256_sub_pd(_mm256_loadu_pd(row(lane)), _mm256_loadu_pd(base(lane)));
    }
    transpose_rows(rows, part, out);
  }
#else
  Doubles minus[4];
  load_rows4(row, out);
  load_rows4(base, minus);
  for (int k = 0; k < 4; ++k) out[k] -= minus[k];
#endif
}

/// Loads row(l)[k] into lane l of out[k], for k < 2.
template <typename Row>
[[gnu::always_inline]] inline void load_rows2(Row&& row, Doubles (&out)[2]) {
#if defined(WINNOW_ISA_IS_avx512)
  __m512d half[2];
  for (int i = 0; i < 2; ++i) {
    __m512d r = _mm512_castpd128_pd512(_mm_loadu_pd(row(i)));
    r = _mm512_insertf64x2(r, _mm_loadu_pd(row(i + 2)), 1);
    r = _mm512_insertf64x2(r, _mm_loadu_pd(row(i + 4)), 2);
    half[i] = _mm512_insertf64x2(r, _mm_loadu_pd(row(i + 6)), 3);
  }
  out[0].part[0] = _mm512_unpacklo_pd(half[0], half[1]);
  out[1].part[0] = _mm512_unpackhi_pd(half[0], half[1]);
#else
  alignas(64) double stage[2][8];
  for (int lane = 0; lane < 8; ++lane) {
    const double* p = row(lane);
    for (int k = 0; k < 2; ++k) stage[k][lane] = p[k];
  }
  for (int k = 0; k < 2; ++k) out[k] = Doubles::load(stage[k]);
#endif
}

/// Returns *row(l) in lane l.
template <typename Row>
[[gnu::always_inline]] inline Doubles load_rows1(Row&& row) {
  Doubles r;
#if defined(WINNOW_ISA_IS_avx512)
  r.part[0] = _mm512_set_pd(*row(7), *row(6), *row(5), *row(4), *row(3), *row(2), *row(1), *row(0));
#else
  alignas(64) double stage[8];
  for (int lane = 0; lane < 8; ++lane) stage[lane] = *row(lane);
  r = Doubles::load(stage);
#endif
  return r;
}

/// Stores out[i] = byte i of `bytes` + base, for i < 8.
[[gnu::always_inline]] inline void store_bytes(std::uint64_t bytes, std::uint32_t base,
                                               std::uint32_t* out) {
#if defined(WINNOW_ISA_IS_avx512) || defined(WINNOW_ISA_IS_avx2)
  const __m256i wide = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(bytes)));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out),
                      _mm256_add_epi32(wide, _mm256_set1_epi32(static_cast<int>(base))));
#else
  for (unsigned i = 0; i < 8; ++i) {
    out[i] = base + static_cast<std::uint32_t>(bytes >> 8U * i & 0xFFU);
  }
#endif
}

}  // namespace winnow::WINNOW_ISA_NAME
