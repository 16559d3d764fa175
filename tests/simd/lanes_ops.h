#pragma once

// Wraps every operation of simd/lanes/lanes.h, scalar_lane.h, boxes.h, compress.h, permute.h and
// positive_min_max.h in a function on plain pointers, so that tests can compare each instruction
// set with a scalar loop. Arrays have 16 elements unless stated otherwise.

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow::test {

struct LanesOps {
  void (*load_store)(const float* aligned, float* out);
  void (*load_unaligned_store)(const float* in, float* out);
  void (*load_store_uint)(const std::uint32_t* in, std::uint32_t* out);
  void (*broadcast)(float value, float* out);
  void (*broadcast_uint)(std::uint32_t value, std::uint32_t* out);
  void (*count_from)(std::uint32_t base, std::uint32_t* out);
  void (*min)(const float* a, const float* b, float* out);
  void (*max)(const float* a, const float* b, float* out);
  void (*add)(const float* a, const float* b, float* out);
  void (*multiply)(const float* a, const float* b, float* out);
  void (*divide)(const float* a, const float* b, float* out);
  void (*sqrt)(const float* in, float* out);
  void (*multiply_add)(const float* a, const float* b, const float* c, float* out);
  std::uint32_t (*less_equal)(const float* a, const float* b);
  void (*keep_less_equal)(const float* a, const float* b, const float* v, float* out);
  float (*reduce_min)(const float* in);
  float (*reduce_max)(const float* in);
  unsigned (*count)(std::uint32_t mask);
  unsigned (*first)(std::uint32_t mask);
  std::uint32_t (*lanes_below)(unsigned lanes);
  /// `columns`: the lower ends of the slabs, then the upper ends; `row`: a multiple of 16.
  std::uint32_t (*overlap3)(const float* const* columns, std::size_t row, const float* low,
                            const float* high);
  std::uint32_t (*overlap13)(const float* const* columns, std::size_t row, const float* low,
                             const float* high);
  std::uint32_t (*overlap3_unaligned)(const float* const* columns, std::size_t row,
                                      const float* low, const float* high);
  unsigned (*compress_store)(std::uint32_t mask, const std::uint32_t* in, std::uint32_t* out);
  unsigned (*compress_store_floats)(std::uint32_t mask, const float* in, float* out);
  /// `out` has 32 elements.
  unsigned (*emit_pairs)(std::uint32_t mask, const std::uint32_t* in, std::uint32_t q,
                         std::uint32_t* out);
  unsigned (*emit_sorted_pairs)(std::uint32_t mask, const std::uint32_t* in, std::uint32_t q,
                                std::uint32_t* out);
  /// `from` has 16 or 32 floats.
  void (*load_packed)(const std::uint32_t* p, float (*axis)[16]);
  void (*pick_of_16)(const float* from, const std::uint8_t* place, float* out);
  void (*pick_of_32)(const float* from, const std::uint8_t* place, float* out);
  /// `place` has 48 numbers.
  bool (*are_below_16)(const std::uint8_t* place);
  bool (*are_below_32)(const std::uint8_t* place);
  void (*larger_positive)(const float* a, const float* b, float* out);
  void (*smaller_positive)(const float* a, const float* b, float* out);
  std::uint32_t (*reduce_min_positive)(const float* in);
  /// Writes kScalarResults results, each of an operation on the two doubles: `scalar` computes on
  /// the scalar path, `in_lanes` in lanes.
  void (*scalar)(double a, double b, double* out);
  void (*in_lanes)(double a, double b, double* out);
  const char* isa_name;
};
inline constexpr int kScalarResults = 20;

WINNOW_KERNELS(LanesOps, lanes_ops);

}  // namespace winnow::test
