#pragma once

// Which vertex of a hull lies farthest along a direction, sixteen vertices at a time.

#include "pipeline/kernels/hull/hull_pair.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// The four low bits of a float give way to a lane's number, so that a maximum also says where it
/// was found: an error of 16 units in the last place in the choice of a vertex.
inline constexpr std::uint32_t kLaneBits = 15;

[[gnu::always_inline]] static inline Floats with_lane_number(const Floats& value) {
#define WINNOW_LANE_NUMBER(i) __builtin_bit_cast(float, std::uint32_t{i})
  alignas(64) static constexpr float kNumbers[16] = {
      WINNOW_LANE_NUMBER(0),  WINNOW_LANE_NUMBER(1),  WINNOW_LANE_NUMBER(2),
      WINNOW_LANE_NUMBER(3),  WINNOW_LANE_NUMBER(4),  WINNOW_LANE_NUMBER(5),
      WINNOW_LANE_NUMBER(6),  WINNOW_LANE_NUMBER(7),  WINNOW_LANE_NUMBER(8),
      WINNOW_LANE_NUMBER(9),  WINNOW_LANE_NUMBER(10), WINNOW_LANE_NUMBER(11),
      WINNOW_LANE_NUMBER(12), WINNOW_LANE_NUMBER(13), WINNOW_LANE_NUMBER(14),
      WINNOW_LANE_NUMBER(15)};
#undef WINNOW_LANE_NUMBER
  const Floats numbers = Floats::load(kNumbers);
  const Floats keep(__builtin_bit_cast(float, ~kLaneBits));
  return (value & keep) | numbers;
}

[[gnu::always_inline]] static inline Floats along(const float* const* vertex, std::uint32_t row,
                                                  const Vec3<float>& d) {
  return Floats::load(vertex[0] + row) * d.x + Floats::load(vertex[1] + row) * d.y +
         Floats::load(vertex[2] + row) * d.z;
}

/// Sixteen heights along `direction`, of which the largest is the hull's, with its lane's number in
/// the low bits; `block` gets the block of each where there is more than one.
[[gnu::always_inline]] static inline void heights(const HullShape& hull, const float* direction,
                                                  float* height, float* block) {
  const Vec3<float> d{direction[0], direction[1], direction[2]};
  Floats best = with_lane_number(along(hull.vertex_float, 0, d));
  if (hull.vertex_count > 16) {
    Floats where(0.0F);
    for (std::uint32_t row = 16; row < hull.vertex_count; row += 16) {
      const Floats value = with_lane_number(along(hull.vertex_float, row, d));
      const LaneMask<float> higher = value > best;
      best = select(higher, value, best);
      where = select(higher, Floats(static_cast<float>(row)), where);
    }
    where.store(block);
  }
  best.store(height);
}

/// The vertex that a maximum of `heights` names.
[[gnu::always_inline]] static inline std::uint32_t vertex_of(const HullShape& hull, float highest,
                                                             const float* block) {
  std::uint32_t vertex = __builtin_bit_cast(std::uint32_t, highest) & kLaneBits;
  if (hull.vertex_count > 16) vertex += static_cast<std::uint32_t>(block[vertex]);
  // Padding repeats vertex 0.
  return vertex < hull.vertex_count ? vertex : 0;
}

/// The same for one direction.
static inline std::uint32_t farthest_vertex(const HullShape& hull, const float* direction) {
  alignas(64) float height[16];
  alignas(64) float block[16];
  heights(hull, direction, height, block);
  return vertex_of(hull, reduce_max(Floats::load(height)), block);
}

/// The height of the highest vertex along a direction.
static inline float highest_of(const HullShape& hull, const float* direction) {
  const Vec3<float> d{direction[0], direction[1], direction[2]};
  Floats best = along(hull.vertex_float, 0, d);
  for (std::uint32_t row = 16; row < hull.vertex_count; row += 16) {
    best = max(best, along(hull.vertex_float, row, d));
  }
  alignas(64) float value[16];
  best.store(value);
  return reduce_max(Floats::load(value));
}

[[gnu::always_inline]] static inline Doubles along(const double* const* vertex, std::uint32_t row,
                                                   const Vec3<double>& d) {
  return Doubles::load(vertex[0] + row) * d.x + Doubles::load(vertex[1] + row) * d.y +
         Doubles::load(vertex[2] + row) * d.z;
}
[[gnu::always_inline]] static inline const double* const* columns_of(const HullShape& hull,
                                                                     double) {
  return hull.vertex;
}
[[gnu::always_inline]] static inline const float* const* columns_of(const HullShape& hull, float) {
  return hull.vertex_float;
}

/// The largest product of a vertex and `direction`.
template <typename T>
static inline T height_of(const HullShape& hull, const T* direction) {
  constexpr std::uint32_t kWidth = Lanes<T>::kCount;
  const Vec3<T> d{direction[0], direction[1], direction[2]};
  const T* const* vertex = columns_of(hull, T());
  Lanes<T> best = along(vertex, 0, d);
  for (std::uint32_t row = kWidth; row < hull.vertex_count; row += kWidth) {
    best = max(best, along(vertex, row, d));
  }
  alignas(64) T value[kWidth];
  best.store(value);
  for (std::uint32_t half = kWidth / 2; half > 0; half /= 2) {
    for (std::uint32_t i = 0; i < half; ++i) {
      value[i] = value[i] > value[i + half] ? value[i] : value[i + half];
    }
  }
  return value[0];
}

/// The highest vertex along `direction`; false if another one is within `doubt` of it.
template <typename T>
static inline bool sole_vertex(const HullShape& hull, const T* direction, T doubt,
                               std::uint32_t& vertex) {
  constexpr std::uint32_t kWidth = Lanes<T>::kCount;
  const T limit = height_of(hull, direction) - doubt;
  const Vec3<T> d{direction[0], direction[1], direction[2]};
  std::uint32_t found = 0;
  for (std::uint32_t row = 0; row < hull.vertex_count; row += kWidth) {
    Mask16 high = bits(along(columns_of(hull, T()), row, d) >= Lanes<T>(limit));
    const std::uint32_t left = hull.vertex_count - row;
    if (left < kWidth) high &= lanes_below(left);
    if (high == 0) continue;
    if (found == 0) vertex = row + first(high);
    found += winnow::WINNOW_ISA_NAME::count(high);
  }
  return found == 1;
}

/// Vertex i in the hull's own frame.
template <typename T>
[[gnu::always_inline]] static inline void vertex_at(const HullShape& hull, std::uint32_t i, T* x) {
  const T* const* vertex = columns_of(hull, T());
  for (int k = 0; k < 3; ++k) x[k] = vertex[k][i];
}

}  // namespace winnow::WINNOW_ISA_NAME
