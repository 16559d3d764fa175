#pragma once

// The points that a program gives of its own convex sets.

#include <winnow/pipeline/shapes.h>
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME {

[[gnu::always_inline]] inline double square_of(const double* x) {
  return x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
}

/// As SupportShape says of points that are not finite or beyond the radius.
static inline void bring_within(double radius, double* point) {
  double most = 0.0;
  for (int k = 0; k < 3; ++k)
    most = most > __builtin_fabs(point[k]) ? most : __builtin_fabs(point[k]);
  const bool finite = most - most == 0.0 && square_of(point) >= 0.0;
  double share[3];
  for (int k = 0; k < 3; ++k) share[k] = finite && most > 0.0 ? point[k] / most : 0.0;
  const double length = __builtin_sqrt(square_of(share));
  const double reach = radius < most * length ? radius / length : most;
  for (int k = 0; k < 3; ++k) point[k] = share[k] * reach;
}

/// The point that a program gives of its own set, times `scale`; 0 of a set that is gone.
template <typename T>
static inline void own_support(const SupportShape& shape, const T* d, T scale, T* x) {
  double direction[3] = {static_cast<double>(d[0]), static_cast<double>(d[1]),
                         static_cast<double>(d[2])};
  const double length = __builtin_sqrt(square_of(direction));
  for (int k = 0; k < 3; ++k) direction[k] = length > 0.0 ? direction[k] / length : k == 0;
  double point[3] = {0.0, 0.0, 0.0};
  if (shape.function != nullptr) shape.function(shape.context, direction, point);
  if (!(square_of(point) <= shape.radius * shape.radius)) bring_within(shape.radius, point);
  for (int k = 0; k < 3; ++k) x[k] = static_cast<T>(point[k]) * scale;
}

}  // namespace winnow::WINNOW_ISA_NAME
