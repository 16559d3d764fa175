#pragma once

// Wraps every operation of simd/lanes/rows.h and triangle_lanes.h in a function on plain pointers.

#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow::test {

/// `rows`: eight addresses. Output: column k at out + 8 k.
struct RowsOps {
  void (*load_rows4)(const double* const* rows, double* out);
  void (*load_differences4)(const double* const* rows, const double* const* base, double* out);
  void (*load_rows2)(const double* const* rows, double* out);
  void (*load_rows1)(const double* const* rows, double* out);
  /// Converts sixteen doubles to floats and back.
  void (*to_single)(const double* in, float* out);
  void (*to_double)(const float* in, double* out);
  void (*store_bytes)(std::uint64_t bytes, std::uint32_t base, std::uint32_t* out);
  void (*negate)(const double* in, double* out);
  /// `corners`: three addresses of four floats. Output: axis k at out + 4 k; with `next`, each lane
  /// gets the number of the following corner.
  void (*load_corners)(const float* const* corners, bool next, double* out);
  /// Copies three numbers to four lanes, cyclically.
  void (*join_corners)(const double* in, double* out);
};

WINNOW_KERNELS(RowsOps, rows_ops);

}  // namespace winnow::test
