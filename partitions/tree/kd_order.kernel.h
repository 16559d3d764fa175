#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// A set of points with their rows, and columns of the same size as scratch. A set is cut in place:
/// its parts are sets in the same columns.
struct KdSet {
  float* at[3] = {};
  std::uint32_t* row = nullptr;
  float* at_room[3] = {};
  std::uint32_t* row_room = nullptr;
  std::size_t count = 0;

  [[nodiscard]] std::size_t size() const { return count; }
};

struct KdOrderKernels {
  /// Writes the centres of the boxes of rows[begin, end) to entries [begin, end) of the columns
  /// `at`.
  void (*centres)(const float* const* boxes, const std::uint32_t* rows, std::size_t begin,
                  std::size_t end, float* const* at);
  /// Cuts a set of more than 16 points near the median of the axis with the largest range: the
  /// first side remains in `set`, the second is returned.
  KdSet (*split)(KdSet& set);
  /// Cuts a set until no part has more than 16 points.
  void (*finish)(KdSet set);
};

WINNOW_KERNELS(KdOrderKernels, kd_order_kernels);

}  // namespace winnow
