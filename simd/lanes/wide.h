#pragma once

// Sixteen lanes of float or unsigned on any instruction set, for kernel files only. One register on
// AVX-512, two on AVX2, four on SSE4.2 and NEON: since a block is 16 rows everywhere, kernels visit
// and report in the same order on every instruction set.
//
// The only file that spells xsimd (8.1 to 14) and intrinsics. xsimd 8.1 has no bit mask of a
// batch_bool, no compress and no reduction by min or max: those are spelled here per instruction
// set.

#ifndef WINNOW_ISA_NAME
#error "wide.h is for *.kernel.cpp files, which the build compiles once per instruction set"
#endif

#include <cstddef>
#include <cstdint>
#include <xsimd/xsimd.hpp>

namespace winnow::WINNOW_ISA_NAME {

inline constexpr int kLanes = 16;
using FloatPart = xsimd::batch<float>;
using UintPart = xsimd::batch<std::uint32_t>;
inline constexpr int kPartLanes = static_cast<int>(FloatPart::size);
inline constexpr int kParts = kLanes / kPartLanes;

/// One bit a lane; lane 0 is bit 0.
using Mask16 = std::uint32_t;

struct Float16 {
  FloatPart part[kParts];
};

struct Uint16 {
  UintPart part[kParts];
};

/// `p` is 64-byte aligned.
inline Float16 load(const float* p) {
  Float16 r;
  for (int i = 0; i < kParts; ++i) r.part[i] = FloatPart::load_aligned(p + i * kPartLanes);
  return r;
}
inline Float16 load_unaligned(const float* p) {
  Float16 r;
  for (int i = 0; i < kParts; ++i) r.part[i] = FloatPart::load_unaligned(p + i * kPartLanes);
  return r;
}
inline Uint16 load_unaligned(const std::uint32_t* p) {
  Uint16 r;
  for (int i = 0; i < kParts; ++i) r.part[i] = UintPart::load_unaligned(p + i * kPartLanes);
  return r;
}
inline Float16 broadcast(float value) {
  Float16 r;
  for (int i = 0; i < kParts; ++i) r.part[i] = FloatPart(value);
  return r;
}
inline void store_unaligned(float* p, const Float16& v) {
  for (int i = 0; i < kParts; ++i) v.part[i].store_unaligned(p + i * kPartLanes);
}
/// Lane-wise smaller and larger; no lane may be NaN.
inline Float16 min(const Float16& a, const Float16& b) {
  Float16 r;
  for (int i = 0; i < kParts; ++i) r.part[i] = xsimd::min(a.part[i], b.part[i]);
  return r;
}
inline Float16 max(const Float16& a, const Float16& b) {
  Float16 r;
  for (int i = 0; i < kParts; ++i) r.part[i] = xsimd::max(a.part[i], b.part[i]);
  return r;
}
inline Float16 add(const Float16& a, const Float16& b) {
  Float16 r;
  for (int i = 0; i < kParts; ++i) r.part[i] = a.part[i] + b.part[i];
  return r;
}
inline Float16 subtract(const Float16& a, const Float16& b) {
  Float16 r;
  for (int i = 0; i < kParts; ++i) r.part[i] = a.part[i] - b.part[i];
  return r;
}
inline Float16 multiply(const Float16& a, const Float16& b) {
  Float16 r;
  for (int i = 0; i < kParts; ++i) r.part[i] = a.part[i] * b.part[i];
  return r;
}

/// a * b + c, rounded once or twice as the instruction set has it: for bounds alone, whose callers
/// allow for either.
inline Float16 multiply_add(const Float16& a, const Float16& b, const Float16& c) {
  Float16 r;
  for (int i = 0; i < kParts; ++i) {
#if defined(WINNOW_ISA_IS_avx512)
    r.part[i] = _mm512_fmadd_ps(a.part[i], b.part[i], c.part[i]);
#elif defined(WINNOW_ISA_IS_avx2)
    r.part[i] = _mm256_fmadd_ps(a.part[i], b.part[i], c.part[i]);
#elif defined(WINNOW_ISA_IS_neon64)
    r.part[i] = vfmaq_f32(c.part[i], a.part[i], b.part[i]);
#else
    r.part[i] = a.part[i] * b.part[i] + c.part[i];
#endif
  }
  return r;
}

/// base, base + 1, ..., base + 15.
inline Uint16 count_from(std::uint32_t base) {
  alignas(64) static constexpr std::uint32_t kSteps[kLanes] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                               8, 9, 10, 11, 12, 13, 14, 15};
  Uint16 r;
  for (int i = 0; i < kParts; ++i) {
    r.part[i] = UintPart::load_aligned(kSteps + i * kPartLanes) + UintPart(base);
  }
  return r;
}
inline Uint16 broadcast(std::uint32_t value) {
  Uint16 r;
  for (int i = 0; i < kParts; ++i) r.part[i] = UintPart(value);
  return r;
}
inline void store_unaligned(std::uint32_t* p, const Uint16& v) {
  for (int i = 0; i < kParts; ++i) v.part[i].store_unaligned(p + i * kPartLanes);
}

/// Number of set bits.
inline unsigned count(Mask16 mask) {
  return static_cast<unsigned>(__builtin_popcount(mask));
}
/// Index of the lowest set bit; `mask` is not 0.
inline unsigned first(Mask16 mask) {
  return static_cast<unsigned>(__builtin_ctz(mask));
}
/// The lowest n lanes, n <= 16.
inline constexpr Mask16 lanes_below(unsigned n) {
  return (1U << n) - 1U;
}

#if defined(WINNOW_ISA_IS_avx512)

inline Mask16 bits(xsimd::batch_bool<float> b) {
  return static_cast<__mmask16>(static_cast<typename xsimd::batch_bool<float>::register_type>(b));
}

#elif defined(WINNOW_ISA_IS_avx2)

inline Mask16 bits(xsimd::batch_bool<float> b) {
  return static_cast<Mask16>(_mm256_movemask_ps(b));
}

#elif defined(WINNOW_ISA_IS_sse42)

inline Mask16 bits(xsimd::batch_bool<float> b) {
  return static_cast<Mask16>(_mm_movemask_ps(b));
}

#else

inline Mask16 bits(xsimd::batch_bool<float> b) {
  const uint32x4_t lane_bits = {1U, 2U, 4U, 8U};
  return vaddvq_u32(vandq_u32(static_cast<uint32x4_t>(b), lane_bits));
}

#endif

/// a <= b; false where either is NaN.
inline Mask16 less_equal(const Float16& a, const Float16& b) {
  Mask16 r = 0;
  for (int i = 0; i < kParts; ++i) r |= bits(a.part[i] <= b.part[i]) << (i * kPartLanes);
  return r;
}

/// v where a <= b, infinity elsewhere.
inline Float16 keep_less_equal(const Float16& a, const Float16& b, const Float16& v) {
  Float16 r;
  const FloatPart infinity(__builtin_inff());
  for (int i = 0; i < kParts; ++i) {
    r.part[i] = xsimd::select(a.part[i] <= b.part[i], v.part[i], infinity);
  }
  return r;
}

/// Smallest lane; no NaN.
inline float reduce_min(const Float16& v) {
  FloatPart m = v.part[0];
  for (int i = 1; i < kParts; ++i) m = xsimd::min(m, v.part[i]);
#if defined(WINNOW_ISA_IS_avx512)
  return _mm512_reduce_min_ps(m);
#elif defined(WINNOW_ISA_IS_neon64)
  return vminvq_f32(m);
#else
#if defined(WINNOW_ISA_IS_avx2)
  const __m256 w = m;
  __m128 x = _mm_min_ps(_mm256_castps256_ps128(w), _mm256_extractf128_ps(w, 1));
#else
  __m128 x = m;
#endif
  x = _mm_min_ps(x, _mm_movehl_ps(x, x));
  x = _mm_min_ss(x, _mm_movehdup_ps(x));
  return _mm_cvtss_f32(x);
#endif
}

/// Largest lane; no NaN.
inline float reduce_max(const Float16& v) {
  FloatPart m = v.part[0];
  for (int i = 1; i < kParts; ++i) m = xsimd::max(m, v.part[i]);
#if defined(WINNOW_ISA_IS_avx512)
  return _mm512_reduce_max_ps(m);
#elif defined(WINNOW_ISA_IS_neon64)
  return vmaxvq_f32(m);
#else
#if defined(WINNOW_ISA_IS_avx2)
  const __m256 w = m;
  __m128 x = _mm_max_ps(_mm256_castps256_ps128(w), _mm256_extractf128_ps(w, 1));
#else
  __m128 x = m;
#endif
  x = _mm_max_ps(x, _mm_movehl_ps(x, x));
  x = _mm_max_ss(x, _mm_movehdup_ps(x));
  return _mm_cvtss_f32(x);
#endif
}

#if defined(WINNOW_ISA_IS_avx512)

/// Lane i is the smallest (largest) of the floats [16 i, 16 i + 16) of 256 at p, which is 64-byte
/// aligned: a transposition that halves by min (max) at every step, a third of the work of sixteen
/// reductions.
template <typename Pick>
inline Float16 reduce_rows(const float* p, Pick&& pick) {
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
  Float16 r;
  r.part[0] = pick(_mm512_shuffle_f32x4(low, high, 0x88), _mm512_shuffle_f32x4(low, high, 0xDD));
  return r;
}
inline Float16 reduce_min_rows(const float* p) {
  return reduce_rows(p, [](__m512 a, __m512 b) { return _mm512_min_ps(a, b); });
}
inline Float16 reduce_max_rows(const float* p) {
  return reduce_rows(p, [](__m512 a, __m512 b) { return _mm512_max_ps(a, b); });
}

#elif defined(WINNOW_ISA_IS_avx2)

template <typename Pick>
inline Float16 reduce_rows(const float* p, Pick&& pick) {
  Float16 r;
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
inline Float16 reduce_min_rows(const float* p) {
  return reduce_rows(p, [](__m256 a, __m256 b) { return _mm256_min_ps(a, b); });
}
inline Float16 reduce_max_rows(const float* p) {
  return reduce_rows(p, [](__m256 a, __m256 b) { return _mm256_max_ps(a, b); });
}

#else

inline Float16 reduce_min_rows(const float* p) {
  alignas(64) float lane[kLanes];
  for (int i = 0; i < kLanes; ++i) lane[i] = reduce_min(load(p + i * kLanes));
  return load(lane);
}
inline Float16 reduce_max_rows(const float* p) {
  alignas(64) float lane[kLanes];
  for (int i = 0; i < kLanes; ++i) lane[i] = reduce_max(load(p + i * kLanes));
  return load(lane);
}

#endif

/// Sixteen boxes, or sixteen volumes of `Slabs` slabs: the lower ends, then the upper ends.
template <int Slabs>
struct Slabs16 {
  Float16 low[Slabs];
  Float16 high[Slabs];
};
using Box16 = Slabs16<3>;

/// Rows [row, row + 16) of columns; `row` is a multiple of 16. A call would pass the boxes through
/// memory, and compilers stop inlining in files that instantiate a kernel many times.
template <int Slabs>
[[gnu::always_inline]] inline Slabs16<Slabs> load_slabs(const float* const* columns,
                                                        std::size_t row) {
  Slabs16<Slabs> r;
  for (int s = 0; s < Slabs; ++s) {
    r.low[s] = load(columns[s] + row);
    r.high[s] = load(columns[Slabs + s] + row);
  }
  return r;
}
template <int Slabs>
[[gnu::always_inline]] inline Slabs16<Slabs> load_slabs_unaligned(const float* const* columns,
                                                                  std::size_t row) {
  Slabs16<Slabs> r;
  for (int s = 0; s < Slabs; ++s) {
    r.low[s] = load_unaligned(columns[s] + row);
    r.high[s] = load_unaligned(columns[Slabs + s] + row);
  }
  return r;
}

/// Which lanes' bits are set in a bitmap: bit i is bit i % 32 of words[i / 32].
inline Mask16 test_bits(const std::uint32_t* words, const Uint16& index) {
#if defined(WINNOW_ISA_IS_avx512)
  const __m512i i = index.part[0];
  const __m512i word = _mm512_i32gather_epi32(_mm512_srli_epi32(i, 5), words, 4);
  const __m512i bit =
      _mm512_sllv_epi32(_mm512_set1_epi32(1), _mm512_and_si512(i, _mm512_set1_epi32(31)));
  return _mm512_test_epi32_mask(word, bit);
#elif defined(WINNOW_ISA_IS_avx2)
  Mask16 r = 0;
  for (int p = 0; p < kParts; ++p) {
    const __m256i i = index.part[p];
    const __m256i word =
        _mm256_i32gather_epi32(reinterpret_cast<const int*>(words), _mm256_srli_epi32(i, 5), 4);
    // The wanted bit becomes the sign bit.
    const __m256i up =
        _mm256_sub_epi32(_mm256_set1_epi32(31), _mm256_and_si256(i, _mm256_set1_epi32(31)));
    const __m256 sign = _mm256_castsi256_ps(_mm256_sllv_epi32(word, up));
    r |= static_cast<Mask16>(_mm256_movemask_ps(sign)) << (p * kPartLanes);
  }
  return r;
#else
  alignas(64) std::uint32_t lane[kLanes];
  store_unaligned(lane, index);
  Mask16 r = 0;
  for (int i = 0; i < kLanes; ++i) r |= (words[lane[i] >> 5U] >> (lane[i] & 31U) & 1U) << i;
  return r;
#endif
}

/// Which of 16 volumes overlap the one whose ends are low[s], high[s]; closed.
template <int Slabs>
[[gnu::always_inline]] inline Mask16 overlap(const Slabs16<Slabs>& v, const float* low,
                                             const float* high) {
#if defined(WINNOW_ISA_IS_avx512)
  // Each compare masks the next: saves the `and` of masks, which has one port only.
  __mmask16 m = 0xFFFF;
  for (int s = 0; s < Slabs; ++s) {
    m = _mm512_mask_cmp_ps_mask(m, v.low[s].part[0], _mm512_set1_ps(high[s]), _CMP_LE_OQ);
    m = _mm512_mask_cmp_ps_mask(m, v.high[s].part[0], _mm512_set1_ps(low[s]), _CMP_GE_OQ);
  }
  return m;
#else
  Mask16 r = 0;
  for (int i = 0; i < kParts; ++i) {
    auto hit = (v.low[0].part[i] <= FloatPart(high[0])) & (FloatPart(low[0]) <= v.high[0].part[i]);
    for (int s = 1; s < Slabs; ++s) {
      hit =
          hit & (v.low[s].part[i] <= FloatPart(high[s])) & (FloatPart(low[s]) <= v.high[s].part[i]);
    }
    r |= bits(hit) << (i * kPartLanes);
  }
  return r;
#endif
}

}  // namespace winnow::WINNOW_ISA_NAME
