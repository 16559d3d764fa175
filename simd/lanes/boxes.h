#pragma once

// Sixteen boxes, or volumes of more slabs, in lanes: loads them from columns or from separate
// addresses, and tests them for overlap with one other volume (QueryBox).

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Sixteen volumes of `Slabs` slabs, 3 for boxes: the lower ends, then the upper ends.
template <int Slabs>
struct Slabs16 {
  Floats low[Slabs];
  Floats high[Slabs];
};
using Box16 = Slabs16<3>;

/// The box in row r of six columns.
struct QueryBox {
  float low[3];
  float high[3];
  [[gnu::always_inline]] QueryBox(const float* const* column, std::size_t r)
      : low{column[0][r], column[1][r], column[2][r]},
        high{column[3][r], column[4][r], column[5][r]} {}
};

/// Loads rows [row, row + 16) of columns; `row` is a multiple of 16. Always inline, because a call
/// would pass the boxes through memory, and compilers stop inlining in files that instantiate a
/// kernel many times.
template <int Slabs>
[[gnu::always_inline]] inline Slabs16<Slabs> load_slabs(const float* const* columns,
                                                        std::size_t row) {
  Slabs16<Slabs> r;
  for (int s = 0; s < Slabs; ++s) {
    r.low[s] = Floats::load(columns[s] + row);
    r.high[s] = Floats::load(columns[Slabs + s] + row);
  }
  return r;
}
template <int Slabs>
[[gnu::always_inline]] inline Slabs16<Slabs> load_slabs_unaligned(const float* const* columns,
                                                                  std::size_t row) {
  Slabs16<Slabs> r;
  for (int s = 0; s < Slabs; ++s) {
    r.low[s] = Floats::load_unaligned(columns[s] + row);
    r.high[s] = Floats::load_unaligned(columns[Slabs + s] + row);
  }
  return r;
}

/// Returns the lanes whose volumes overlap the volume with ends low[s], high[s]; closed.
template <int Slabs>
[[gnu::always_inline]] inline Mask16 overlap(const Slabs16<Slabs>& v, const float* low,
                                             const float* high) {
#if defined(WINNOW_ISA_IS_avx512)
  // The second compare of a slab is masked by the first, which saves an `and` of masks. One chain
  // of all compares would save more of them, but its latency is more than loops can hide.
  const auto slab = [&](int s) {
    const __mmask16 begins =
        _mm512_cmp_ps_mask(v.low[s].part[0], _mm512_set1_ps(high[s]), _CMP_LE_OQ);
    return _mm512_mask_cmp_ps_mask(begins, v.high[s].part[0], _mm512_set1_ps(low[s]), _CMP_GE_OQ);
  };
  __mmask16 m = slab(0);
  for (int s = 1; s < Slabs; ++s) m = _kand_mask16(m, slab(s));
  return m;
#else
  Mask16 r = 0;
  for (int i = 0; i < Floats::kParts; ++i) {
    auto hit =
        (v.low[0].part[i] <= Floats::Part(high[0])) & (Floats::Part(low[0]) <= v.high[0].part[i]);
    for (int s = 1; s < Slabs; ++s) {
      hit = hit & (v.low[s].part[i] <= Floats::Part(high[s])) &
            (Floats::Part(low[s]) <= v.high[s].part[i]);
    }
    r |= bits(hit) << (i * Floats::kPartLanes);
  }
  return r;
#endif
}

#if !defined(WINNOW_ISA_IS_neon64)

/// Transposes four floats of each box. Each 128-bit part of row i contains four floats of one box:
/// the box of lane i in the first part, then the boxes of lanes i + 4, i + 8 and i + 12 if the
/// register has more parts. Shuffles within 128 bits then leave the lanes in order.
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

/// Loads boxes from separate addresses: lane l of the result is the box of six contiguous floats
/// (min xyz, max xyz) at box(l). Boxes are loaded whole and transposed in registers, which takes
/// fewer instructions than loading single floats.
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
    r.low[s] = Floats::load(stage[s]);
    r.high[s] = Floats::load(stage[3 + s]);
  }
#else
  // Loads floats 0..3 and 2..5 of each box, and so nothing behind the last box.
  for (int part = 0; part < Floats::kParts; ++part) {
    const BoxQuads head(box, part * Floats::kPartLanes, 0);
    const BoxQuads rest(box, part * Floats::kPartLanes, 2);
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
