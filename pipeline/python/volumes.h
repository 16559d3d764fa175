#pragma once

#include "core/numbers/rounding.h"
#include "pipeline/python/arrays.h"

#include <winnow/core/regions.h>
#include <winnow/core/volumes.h>

#include <algorithm>
#include <cmath>

namespace winnow::python {

// Volumes in float that contain volumes given in double.

[[nodiscard]] inline Vec3f point_at(const Numbers& numbers, std::size_t i) {
  Vec3f point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    point[axis] = static_cast<float>(numbers.at(i, axis));
  }
  return point;
}

/// Upper bound on the distance between the point in float and the given one.
[[nodiscard]] inline double off_point_at(const Numbers& numbers, std::size_t i) {
  const Vec3f point = point_at(numbers, i);
  double square = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double off = numbers.at(i, axis) - static_cast<double>(point[axis]);
    square += off * off;
  }
  return std::sqrt(square) * (1.0 + 1e-15);
}

/// Returns an upper bound of the sum in float; a negative length is only rounded, NaN stays NaN.
[[nodiscard]] inline float grown(double length, double by) {
  return round_up(length >= 0.0 && by > 0.0 ? add_up(length, by) : length);
}

[[nodiscard]] inline Aabb box_at(const Numbers& lower, const Numbers& upper, std::size_t i) {
  Aabb box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.min[axis] = round_down(lower.at(i, axis));
    box.max[axis] = round_up(upper.at(i, axis));
  }
  return box;
}

[[nodiscard]] inline Sphere sphere_at(const Numbers& center, const Numbers& radius, std::size_t i) {
  return {point_at(center, i), grown(radius.at(i), off_point_at(center, i))};
}

[[nodiscard]] inline Capsule capsule_at(const Numbers& a, const Numbers& b, const Numbers& radius,
                                        std::size_t i) {
  return {point_at(a, i), point_at(b, i),
          grown(radius.at(i), std::max(off_point_at(a, i), off_point_at(b, i)))};
}

}  // namespace winnow::python
