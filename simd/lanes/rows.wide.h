#pragma once

// Rows of doubles, each at an address of its own, into lanes, and lanes from one precision to the
// other. Rows are loaded whole and transposed in registers: gather instructions take several times
// as long, and loads of what scalars have just staged wait for the stores.

#include "simd/lanes/real.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// Lanes of double.
using Double8 = Real<double>;
/// Lanes of float.
using Single16 = Real<float>;

#if defined(WINNOW_ISA_IS_avx512)

[[gnu::always_inline]] inline __m512d two_rows(const double* low, const double* high) {
  return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(low)), _mm256_loadu_pd(high), 1);
}
/// From rows 0 and 2, 1 and 3, 4 and 6, 5 and 7.
[[gnu::always_inline]] inline void transpose_rows(const __m512d (&row)[4], Double8 (&out)[4]) {
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
                                                  Double8 (&out)[4]) {
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

/// Lane l of out[k] is row(l)[k] for k < 4.
template <typename Row>
[[gnu::always_inline]] inline void load_rows4(Row&& row, Double8 (&out)[4]) {
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
  for (int k = 0; k < 4; ++k) out[k] = Double8::load(stage[k]);
#endif
}

/// Lane l of out[k] is row(l)[k] - base(l)[k] for k < 4.
template <typename Row, typename Base>
[[gnu::always_inline]] inline void load_differences4(Row&& row, Base&& base, Double8 (&out)[4]) {
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
  Double8 minus[4];
  load_rows4(row, out);
  load_rows4(base, minus);
  for (int k = 0; k < 4; ++k) out[k] -= minus[k];
#endif
}

/// Lane l of out[k] is row(l)[k] for k < 2.
template <typename Row>
[[gnu::always_inline]] inline void load_rows2(Row&& row, Double8 (&out)[2]) {
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
  for (int k = 0; k < 2; ++k) out[k] = Double8::load(stage[k]);
#endif
}

/// Lane l is *row(l).
template <typename Row>
[[gnu::always_inline]] inline Double8 load_rows1(Row&& row) {
  Double8 r;
#if defined(WINNOW_ISA_IS_avx512)
  r.part[0] = _mm512_set_pd(*row(7), *row(6), *row(5), *row(4), *row(3), *row(2), *row(1), *row(0));
#else
  alignas(64) double stage[8];
  for (int lane = 0; lane < 8; ++lane) stage[lane] = *row(lane);
  r = Double8::load(stage);
#endif
  return r;
}

/// out[i] = byte i of `bytes` + base, for i < 8.
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

/// Lanes rounded to the nearest float: `low` becomes lanes 0 to 7.
[[gnu::always_inline]] inline Single16 to_single(const Double8& low, const Double8& high) {
  Single16 r;
#if defined(WINNOW_ISA_IS_avx512)
  r.part[0] = _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(low.part[0])),
                                 _mm512_cvtpd_ps(high.part[0]), 1);
#elif defined(WINNOW_ISA_IS_avx2)
  r.part[0] = _mm256_set_m128(_mm256_cvtpd_ps(low.part[1]), _mm256_cvtpd_ps(low.part[0]));
  r.part[1] = _mm256_set_m128(_mm256_cvtpd_ps(high.part[1]), _mm256_cvtpd_ps(high.part[0]));
#else
  alignas(64) double from[16];
  alignas(64) float to[16];
  low.store(from);
  high.store(from + 8);
  for (int lane = 0; lane < 16; ++lane) to[lane] = static_cast<float>(from[lane]);
  r = Single16::load(to);
#endif
  return r;
}

/// The same of eight lanes; lanes 8 to 15 are unspecified.
[[gnu::always_inline]] inline Single16 to_single(const Double8& v) {
#if defined(WINNOW_ISA_IS_avx512)
  Single16 r;
  r.part[0] = _mm512_castps256_ps512(_mm512_cvtpd_ps(v.part[0]));
  return r;
#else
  return to_single(v, v);
#endif
}

/// Lanes 0 to 7, or 8 to 15, in double.
template <int Half>
[[gnu::always_inline]] inline Double8 to_double(const Single16& v) {
  Double8 r;
#if defined(WINNOW_ISA_IS_avx512)
  r.part[0] = _mm512_cvtps_pd(_mm512_extractf32x8_ps(v.part[0], Half));
#elif defined(WINNOW_ISA_IS_avx2)
  const __m256 half = v.part[Half];
  r.part[0] = _mm256_cvtps_pd(_mm256_castps256_ps128(half));
  r.part[1] = _mm256_cvtps_pd(_mm256_extractf128_ps(half, 1));
#else
  alignas(64) float from[16];
  alignas(64) double to[8];
  v.store(from);
  for (int lane = 0; lane < 8; ++lane) to[lane] = static_cast<double>(from[Half * 8 + lane]);
  r = Double8::load(to);
#endif
  return r;
}

}  // namespace winnow::WINNOW_ISA_NAME
