#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Points, each with the row that it belongs to, and room for as many. A set is cut in place:
/// its parts are further sets of the same columns.
struct KdSet {
  float* at[3] = {};
  std::uint32_t* row = nullptr;
  float* at_room[3] = {};
  std::uint32_t* row_room = nullptr;
  std::size_t count = 0;

  [[nodiscard]] std::size_t size() const { return count; }
};

struct KdOrderKernels {
  /// Writes the centres of the boxes of rows[begin, end) to the same places of the columns `at`.
  void (*centres)(const float* const* boxes, const std::uint32_t* rows, std::size_t begin,
                  std::size_t end, float* const* at);
  /// Cuts a set of more than 16 points at the middle of the axis along which it reaches farthest:
  /// leaves the first side to `set` and returns the other.
  KdSet (*split)(KdSet& set);
  /// Cuts a set until no part has more than 16 points.
  void (*finish)(KdSet set);
};

WINNOW_KERNELS(KdOrderKernels, kd_order_kernels);

}  // namespace winnow
