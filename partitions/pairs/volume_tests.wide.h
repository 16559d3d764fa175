#pragma once

// Tests of volumes other than boxes.

#include "partitions/pairs/pair_sink.h"
#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

// Columns of a sphere's centre and radius.
inline constexpr int kBallCenter = 6;
inline constexpr int kBallRadius = 9;

/// Balls against the points within `reach` of a box; of a ball, low == high == centre. The right
/// side of |distance|^2 <= (r1 + r2)^2 is enlarged by more than the rounding of both sides (a few
/// ulp of each), so that touching balls are never missed; where a square would overflow or
/// underflow the comparison still errs to the side of a hit.
inline Mask16 balls_meet(const Floats* center, const Floats& radius, const float* low,
                         const float* high, float reach) {
  constexpr float kSlack = 1.000002F;
  constexpr float kTiny = 1e-37F;
  Floats square = Floats(-kTiny);
  for (int axis = 0; axis < 3; ++axis) {
    // Distance of the centre from [low, high] along the axis.
    const Floats below = low[axis] - center[axis];
    const Floats above = center[axis] - high[axis];
    const Floats d = max(max(below, above), Floats(0.0F));
    square = square + d * d;
  }
  const Floats sum = radius + reach;
  const Floats limit = sum * sum * kSlack;
  // An empty row's centre is infinite, and so is its square: infinity <= infinity must not count.
  const Mask16 real = bits(center[0] <= 3.4028234e38F);
  return bits(square <= limit) & real;
}

/// Of the lanes `mask` of the rows from `at` on, whose boxes overlap that of row r of the columns
/// `query`, those whose further slabs do so too.
inline Mask16 further_slabs_overlap(const RowView& rows, std::uint32_t at,
                                    const float* const* query, std::uint32_t r, Mask16 mask) {
  const std::uint32_t slabs = rows.further_slabs;
  for (std::uint32_t low = 6; low < 6 + slabs; ++low) {
    const std::uint32_t high = low + slabs;
    mask &= bits(Floats::load_unaligned(rows.column[low] + at) <= query[high][r]) &
            bits(query[low][r] <= Floats::load_unaligned(rows.column[high] + at));
  }
  return mask;
}

/// The same for spheres.
inline Mask16 spheres_overlap(const RowView& rows, std::uint32_t at, const float* const* query,
                              std::uint32_t r, Mask16 mask) {
  Floats center[3];
  float point[3];
  for (int axis = 0; axis < 3; ++axis) {
    center[axis] = Floats::load_unaligned(rows.column[kBallCenter + axis] + at);
    point[axis] = query[kBallCenter + axis][r];
  }
  const Floats radius = Floats::load_unaligned(rows.column[kBallRadius] + at);
  return mask & balls_meet(center, radius, point, point, query[kBallRadius][r]);
}

}  // namespace winnow::WINNOW_ISA_NAME
