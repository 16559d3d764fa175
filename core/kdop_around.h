#pragma once

#include <winnow/core/kdop.h>
#include <winnow/core/oriented_box.h>
#include <winnow/core/rounding.h>

#include <cmath>
#include <cstddef>
#include <limits>

namespace winnow {

/// Returns a k-DOP of a valid oriented box, rounded outward. Each slab is larger than the tightest
/// one by at most 1e-14 of the sum of the box's coordinates and edges, plus, at each end, two ulp
/// and the smallest normal float.
template <int K>
[[nodiscard]] Kdop<K> kdop_around(const OrientedBox& box) noexcept {
  constexpr auto directions = kdop_directions<K>();
  constexpr float kUlp = 1.2e-7F;  // a little more than 2^-23
  // Smaller numbers may be flushed to 0.
  constexpr float kMinNormal = std::numeric_limits<float>::min();
  double center[3];
  double edge[3][3];  // half edges as vectors
  double size = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    center[axis] = to_double(box.center[axis]);
    size += std::abs(center[axis]);
    for (int i = 0; i < 3; ++i) {
      edge[i][axis] = to_double(box.axes(axis, i)) * to_double(box.half[i]);
      size += std::abs(edge[i][axis]);
    }
  }
  // Exceeds the rounding error of all sums, which is a few 2^-53 of their terms.
  const double slack = 4e-15 * size;
  Kdop<K> result;
  for (std::size_t s = 0; s < Kdop<K>::kSlabs; ++s) {
    const auto along = [&](const double* v) {
      double sum = 0.0;
      for (std::size_t axis = 0; axis < 3; ++axis) sum += directions[s][axis] * v[axis];
      return sum;
    };
    const double middle = along(center);
    const double reach =
        slack + std::abs(along(edge[0])) + std::abs(along(edge[1])) + std::abs(along(edge[2]));
    // The nearest float moves outward by slightly more than one ulp, whichever way it was rounded.
    // Testing the direction would cost more. Ends beyond the float range become the largest float,
    // which a partition treats as infinity.
    const float low = finite_float(middle - reach);
    const float high = finite_float(middle + reach);
    result.min[s] = low - (std::abs(low) * kUlp + kMinNormal);
    result.max[s] = high + (std::abs(high) * kUlp + kMinNormal);
  }
  return result;
}

}  // namespace winnow
