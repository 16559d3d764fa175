#pragma once

#include "partitions/tree/axis_extent.wide.h"
#include "simd/lanes/float_to_uint.h"
#include "simd/lanes/lanes.h"

#include <cstdint>

namespace winnow::WINNOW_ISA_NAME {

/// Points are counted at this many places along an axis, to cut the axis into parts with equal
/// numbers of points.
inline constexpr std::uint32_t kPlaceBits = 7;
inline constexpr std::uint32_t kPlacesPerAxis = 1U << kPlaceBits;

/// Returns the number of places per unit of halved length, for an axis whose range is 2 *
/// `half_reach`.
inline float places_per(float half_reach) {
  return half_reach > kMinExtent ? static_cast<float>(kPlacesPerAxis) / half_reach : 0.0F;
}

/// The places of points on an axis, clamped to its range.
inline Uints places_of(const Floats& x, float half_low, float scale) {
  const Floats at = (0.5F * x - Floats(half_low)) * scale;
  return float_to_uint(min(max(at, Floats(0.0F)), Floats(static_cast<float>(kPlacesPerAxis - 1))));
}

/// Assigns to every place a part of [0, parts), each with about equally many of `all` points.
template <typename Part>
void cut_equally(const std::uint32_t* points, std::uint32_t all, std::uint32_t parts, Part* part) {
  std::uint32_t own = 0;
  std::uint32_t end = 2 * all;  // of the part, times 2 * parts
  std::uint32_t twice = 0;      // points before the place, times 2 * parts
  for (std::uint32_t p = 0; p < kPlacesPerAxis; ++p) {
    const std::uint32_t here = points[p] * parts;
    // Branchless, because the end of a part is unpredictable.
    const std::uint32_t next = static_cast<std::uint32_t>(twice + here >= end) &
                               static_cast<std::uint32_t>(own + 1 < parts);
    own += next;
    end += (0U - next) & (2 * all);
    part[p] = static_cast<Part>(own);
    twice += 2 * here;
  }
}

/// Returns the largest number of points at one place. If it is large, places do not separate the
/// points.
inline std::uint32_t most_at_a_place(const std::uint32_t* points) {
  std::uint32_t most = 0;
  for (std::uint32_t p = 0; p < kPlacesPerAxis; ++p) most = points[p] > most ? points[p] : most;
  return most;
}

/// Sorts the axes by descending length.
inline void order_by_length(const float* length, int* order) {
  const auto swap_if_longer = [&](int a, int b) {
    if (!(length[order[b]] > length[order[a]])) return;
    const int kept = order[a];
    order[a] = order[b];
    order[b] = kept;
  };
  for (int a = 0; a < 3; ++a) order[a] = a;
  swap_if_longer(0, 1);
  swap_if_longer(1, 2);
  swap_if_longer(0, 1);
}

}  // namespace winnow::WINNOW_ISA_NAME
