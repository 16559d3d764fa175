#pragma once

// Boxes that lie one after another in memory, each at an address of its own, into lanes: loaded
// whole and transposed in registers, which takes a quarter of the instructions that floats one by
// one take.

#include "simd/lanes/wide.h"

namespace winnow::WINNOW_ISA_NAME {

#if !defined(WINNOW_ISA_IS_neon64)

/// Four floats of each box of a register's lanes on their way to being transposed: each 128 bits of
/// row i hold a box of lane i, i + 4, i + 8 and i + 12, so that shuffles within 128 bits leave the
/// lanes in order.
struct BoxQuads {
#if defined(WINNOW_ISA_IS_avx512)
  using Row = __m512;
  static Row low(Row a, Row b) {
    return _mm512_unpacklo_ps(a, b);
  }
  static Row high(Row a, Row b) {
    return _mm512_unpackhi_ps(a, b);
  }
  static Row even(Row a, Row b) {
    return _mm512_shuffle_ps(a, b, 0x44);
  }
  static Row odd(Row a, Row b) {
    return _mm512_shuffle_ps(a, b, 0xEE);
  }
#elif defined(WINNOW_ISA_IS_avx2)
  using Row = __m256;
  static Row low(Row a, Row b) {
    return _mm256_unpacklo_ps(a, b);
  }
  static Row high(Row a, Row b) {
    return _mm256_unpackhi_ps(a, b);
  }
  static Row even(Row a, Row b) {
    return _mm256_shuffle_ps(a, b, 0x44);
  }
  static Row odd(Row a, Row b) {
    return _mm256_shuffle_ps(a, b, 0xEE);
  }
#else
  using Row = __m128;
  static Row low(Row a, Row b) {
    return _mm_unpacklo_ps(a, b);
  }
  static Row high(Row a, Row b) {
    return _mm_unpackhi_ps(a, b);
  }
  static Row even(Row a, Row b) {
    return _mm_shuffle_ps(a, b, 0x44);
  }
  static Row odd(Row a, Row b) {
    return _mm_shuffle_ps(a, b, 0xEE);
  }
#endif

  Row low01;
  Row low23;
  Row high01;
  Row high23;

  template <typename Box>
  [[gnu::always_inline]] BoxQuads(Box&& box, int lane, int first_float) {
    Row row[4];
    for (int i = 0; i < 4; ++i) {
      const auto quad = [&](int step) {
        return _mm_loadu_ps(box(lane + i + 4 * step) + first_float);
      };
#if defined(WINNOW_ISA_IS_avx512)
      const __m512 two = _mm512_insertf32x4(_mm512_castps128_ps512(quad(0)), quad(1), 1);
      row[i] = _mm512_insertf32x4(_mm512_insertf32x4(two, quad(2), 2), quad(3), 3);
#elif defined(WINNOW_ISA_IS_avx2)
      row[i] = _mm256_insertf128_ps(_mm256_castps128_ps256(quad(0)), quad(1), 1);
#else
      row[i] = quad(0);
#endif
    }
    low01 = low(row[0], row[1]);
    low23 = low(row[2], row[3]);
    high01 = high(row[0], row[1]);
    high23 = high(row[2], row[3]);
  }
};

#endif

/// Lane l of the result is the box of six floats (min xyz, max xyz) at box(l).
template <typename Box>
[[gnu::always_inline]] inline Box16 load_boxes(Box&& box) {
  Box16 r;
#if defined(WINNOW_ISA_IS_neon64)
  alignas(64) float stage[6][kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    const float* p = box(lane);
    for (int k = 0; k < 6; ++k) stage[k][lane] = p[k];
  }
  for (int s = 0; s < 3; ++s) {
    r.low[s] = load(stage[s]);
    r.high[s] = load(stage[3 + s]);
  }
#else
  // Floats 0..3 and 2..5 of a box: nothing behind the last box is read.
  for (int part = 0; part < kParts; ++part) {
    const BoxQuads head(box, part * kPartLanes, 0);
    const BoxQuads rest(box, part * kPartLanes, 2);
    r.low[0].part[part] = BoxQuads::even(head.low01, head.low23);
    r.low[1].part[part] = BoxQuads::odd(head.low01, head.low23);
    r.low[2].part[part] = BoxQuads::even(head.high01, head.high23);
    r.high[0].part[part] = BoxQuads::odd(head.high01, head.high23);
    r.high[1].part[part] = BoxQuads::even(rest.high01, rest.high23);
    r.high[2].part[part] = BoxQuads::odd(rest.high01, rest.high23);
  }
#endif
  return r;
}

}  // namespace winnow::WINNOW_ISA_NAME
