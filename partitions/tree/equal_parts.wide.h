#pragma once

#include "partitions/tree/reach.wide.h"
#include "simd/lanes/lanes.h"
#include "simd/lanes/truncated.h"

#include <cstdint>

namespace winnow::WINNOW_ISA_NAME {

/// Places along an axis in which points are counted, to cut them into parts of about as many each.
inline constexpr std::uint32_t kPlaceBits = 7;
inline constexpr std::uint32_t kPlaces = 1U << kPlaceBits;

/// Places per length of half of an axis' reach.
inline float places_per(float half_reach) {
  return half_reach > kLeastReach ? static_cast<float>(kPlaces) / half_reach : 0.0F;
}

/// The places of points of an axis: what lies beyond its reach is at the end that is nearer.
inline Uints places_of(const Floats& x, float half_low, float scale) {
  const Floats at = (0.5F * x - Floats(half_low)) * scale;
  return truncated(min(max(at, Floats(0.0F)), Floats(static_cast<float>(kPlaces - 1))));
}

/// Gives every place a part of [0, parts), of about as many of `all` points each.
template <typename Part>
void cut_equally(const std::uint32_t* points, std::uint32_t all, std::uint32_t parts, Part* part) {
  std::uint32_t own = 0;
  std::uint32_t end = 2 * all;  // of the part, as many times as there are parts
  std::uint32_t twice = 0;      // the points before the place, as many times
  for (std::uint32_t p = 0; p < kPlaces; ++p) {
    const std::uint32_t here = points[p] * parts;
    // No branch: it would be a coin toss.
    const std::uint32_t next = static_cast<std::uint32_t>(twice + here >= end) &
                               static_cast<std::uint32_t>(own + 1 < parts);
    own += next;
    end += (0U - next) & (2 * all);
    part[p] = static_cast<Part>(own);
    twice += 2 * here;
  }
}

/// Where many are, places do not tell them apart.
inline std::uint32_t most_at_a_place(const std::uint32_t* points) {
  std::uint32_t most = 0;
  for (std::uint32_t p = 0; p < kPlaces; ++p) most = points[p] > most ? points[p] : most;
  return most;
}

/// The axes in `order`, the longest first.
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
