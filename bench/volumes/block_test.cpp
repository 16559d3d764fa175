#include "volumes/block_test.h"

#if defined(__AVX512BW__) && defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace winnow::bench {
namespace {

#if defined(__AVX512BW__) && defined(__AVX512F__)

/// Appends row + i for each bit i.
std::uint32_t* append(std::uint32_t bits, std::uint32_t row, std::uint32_t* out) {
  for (int half = 0; half < 2; ++half) {
    const auto mask = static_cast<__mmask16>(bits >> (16 * half));
    const __m512i lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const __m512i rows =
        _mm512_add_epi32(lane, _mm512_set1_epi32(static_cast<int>(row) + 16 * half));
    _mm512_storeu_si512(out, _mm512_maskz_compress_epi32(mask, rows));
    out += __builtin_popcount(mask);
  }
  return out;
}

#else

template <typename T>
std::size_t meet_plainly(const T* const* column, const T* box, std::size_t begin,
                         std::uint32_t* out) {
  unsigned char hit[kGroup];
  for (std::size_t i = 0; i < kGroup; ++i) {
    unsigned char all = 1;
    for (int axis = 0; axis < 3; ++axis) {
      all &= static_cast<unsigned char>(column[axis][begin + i] <= box[3 + axis]) &
             static_cast<unsigned char>(box[axis] <= column[3 + axis][begin + i]);
    }
    hit[i] = all;
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < kGroup; ++i) {
    out[count] = static_cast<std::uint32_t>(begin + i);
    count += hit[i];
  }
  return count;
}

#endif

}  // namespace

#if defined(__AVX512BW__) && defined(__AVX512F__)

std::size_t lanes_of_16_bits() {
  return 32;
}
std::size_t lanes_of_floats() {
  return 16;
}

std::size_t meet(const float* const* column, const float* box, std::size_t begin,
                 std::uint32_t* out) {
  const std::uint32_t* const first = out;
  __m512 end[6];
  for (int c = 0; c < 6; ++c) end[c] = _mm512_set1_ps(box[c]);
  for (std::size_t at = begin; at < begin + kGroup; at += 32) {
    std::uint32_t bits = 0;
    for (unsigned half = 0; half < 2; ++half) {
      __mmask16 mask = 0xFFFFU;
      for (int axis = 0; axis < 3; ++axis) {
        const __m512 low = _mm512_loadu_ps(column[axis] + at + 16 * half);
        const __m512 high = _mm512_loadu_ps(column[3 + axis] + at + 16 * half);
        mask = _mm512_mask_cmp_ps_mask(mask, low, end[3 + axis], _CMP_LE_OQ);
        mask = _mm512_mask_cmp_ps_mask(mask, end[axis], high, _CMP_LE_OQ);
      }
      bits |= std::uint32_t{mask} << (16 * half);
    }
    if (bits != 0) out = append(bits, static_cast<std::uint32_t>(at), out);
  }
  return static_cast<std::size_t>(out - first);
}

std::size_t meet(const std::uint16_t* const* column, const std::uint16_t* box, std::size_t begin,
                 std::uint32_t* out) {
  const std::uint32_t* const first = out;
  __m512i end[6];
  for (int c = 0; c < 6; ++c) end[c] = _mm512_set1_epi16(static_cast<short>(box[c]));
  for (std::size_t at = begin; at < begin + kGroup; at += 32) {
    __mmask32 mask = 0xFFFFFFFFU;
    for (int axis = 0; axis < 3; ++axis) {
      const __m512i low = _mm512_loadu_si512(column[axis] + at);
      const __m512i high = _mm512_loadu_si512(column[3 + axis] + at);
      mask = _mm512_mask_cmple_epu16_mask(mask, low, end[3 + axis]);
      mask = _mm512_mask_cmple_epu16_mask(mask, end[axis], high);
    }
    if (mask != 0) out = append(mask, static_cast<std::uint32_t>(at), out);
  }
  return static_cast<std::size_t>(out - first);
}

#else

std::size_t lanes_of_16_bits() {
  return 2 * lanes_of_floats();
}
std::size_t lanes_of_floats() {
#if defined(__AVX2__)
  return 8;
#else
  return 4;
#endif
}
std::size_t meet(const float* const* column, const float* box, std::size_t begin,
                 std::uint32_t* out) {
  return meet_plainly(column, box, begin, out);
}
std::size_t meet(const std::uint16_t* const* column, const std::uint16_t* box, std::size_t begin,
                 std::uint32_t* out) {
  return meet_plainly(column, box, begin, out);
}

#endif

}  // namespace winnow::bench
