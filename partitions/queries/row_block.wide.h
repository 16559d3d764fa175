#pragma once

#include <winnow/partitions/queries/query_view.h>
#include <winnow/simd/wide.h>

namespace winnow::WINNOW_ISA_NAME {

/// The float before, for any float but -infinity.
inline float next_below(float value) {
  std::uint32_t bits;
  __builtin_memcpy(&bits, &value, sizeof bits);
  if ((bits & 0x7FFFFFFFU) == 0) {
    bits = 0x80000001U;
  } else {
    bits = (bits >> 31U) != 0 ? bits + 1 : bits - 1;
  }
  __builtin_memcpy(&value, &bits, sizeof value);
  return value;
}

/// The largest float <= a + b.
inline float add_rounded_down(float a, float b) {
  const double x = static_cast<double>(a);
  const double y = static_cast<double>(b);
  const double sum = x + y;
  // The rounding error of the sum (Knuth, TAOCP vol. 2, 4.2.2, theorem B).
  const double shadow = sum - x;
  const double error = (x - (sum - shadow)) + (y - shadow);
  const float nearest = static_cast<float>(sum);
  const double back = static_cast<double>(nearest);
  return back > sum || (back == sum && error < 0.0) ? next_below(nearest) : nearest;
}

/// Sixteen rows as boxes: where they lie, or, for spheres, the box around each.
class RowBlock {
 public:
  RowBlock(const QueryView& view, std::uint32_t first_row) : at_(first_row) {
    for (int c = 0; c < 6; ++c) column_[c] = view.column[c];
    if (view.spheres) fill(view, first_row);
  }
  RowBlock(const RowBlock&) = delete;
  RowBlock& operator=(const RowBlock&) = delete;

  [[nodiscard]] const float* const* columns() const { return column_; }
  /// Where in the columns lane 0 is.
  [[nodiscard]] std::uint32_t at() const { return at_; }

 private:
  void fill(const QueryView& view, std::uint32_t first_row) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < kLanes; ++i) {
        const float center = view.column[axis][first_row + static_cast<std::uint32_t>(i)];
        const float radius = view.column[3][first_row + static_cast<std::uint32_t>(i)];
        const bool live = center <= 3.4028234e38F;
        box_[axis][i] = live ? add_rounded_down(center, -radius) : __builtin_inff();
        box_[3 + axis][i] = live ? -add_rounded_down(-center, -radius) : -__builtin_inff();
      }
    }
    for (int c = 0; c < 6; ++c) column_[c] = box_[c];
    at_ = 0;
  }

  const float* column_[6];
  std::uint32_t at_;
  alignas(64) float box_[6][kLanes];
};

}  // namespace winnow::WINNOW_ISA_NAME
