#pragma once

// Support points of user shapes, and the distance up to which several support points count as one.

#include <winnow/pipeline/shapes.h>
#include "pipeline/kernels/single_vectors.wide.h"
#include "pipeline/manifold/feature_rules.h"

namespace winnow::WINNOW_ISA_NAME {

/// Enforces the contract of SupportShape: a point that is not finite becomes 0, and a point outside
/// the ball of the shape's radius is moved to the nearest point of the ball.
static inline void bring_within(double radius, double* point) {
  double most = 0.0;
  for (int k = 0; k < 3; ++k)
    most = most > __builtin_fabs(point[k]) ? most : __builtin_fabs(point[k]);
  const bool finite = most - most == 0.0 && dot3(point, point) >= 0.0;
  double share[3];
  for (int k = 0; k < 3; ++k) share[k] = finite && most > 0.0 ? point[k] / most : 0.0;
  const double length = __builtin_sqrt(dot3(share, share));
  const double reach = radius < most * length ? radius / length : most;
  for (int k = 0; k < 3; ++k) point[k] = share[k] * reach;
}

/// Calls the user's support function for a unit direction. Returns 0 for a shape that was removed.
static inline void user_point(const SupportShape& shape, const double (&direction)[3],
                              double (&point)[3]) {
  for (double& x : point) x = 0.0;
  if (shape.function != nullptr) shape.function(shape.context, direction, point);
  if (!(dot3(point, point) <= shape.radius * shape.radius)) bring_within(shape.radius, point);
}

/// Returns the support point for a direction of any length, times `scale`. Most callers pass a unit
/// vector, which is not normalized again.
template <typename T>
static inline void user_support(const SupportShape& shape, const T* d, T scale, T* x) {
  double direction[3] = {static_cast<double>(d[0]), static_cast<double>(d[1]),
                         static_cast<double>(d[2])};
  const double square = dot3(direction, direction);
  if (!(__builtin_fabs(square - 1.0) <= 0x1p-51)) {
    const double over = 1.0 / __builtin_sqrt(square);
    for (int k = 0; k < 3; ++k) direction[k] = square > 0.0 ? direction[k] * over : k == 0;
  }
  double point[3];
  user_point(shape, direction, point);
  for (int k = 0; k < 3; ++k) x[k] = static_cast<T>(point[k]) * scale;
}

static inline double user_width(const SupportShape& shape, const double* d, double scale) {
  const double back[3] = {-d[0], -d[1], -d[2]};
  double high[3];
  double low[3];
  user_support(shape, d, scale, high);
  user_support(shape, back, scale, low);
  return dot3(d, high) - dot3(d, low);
}

/// Returns the distance, times `scale`, up to which the support points for directions within
/// kSampleTilt of the normal count as one point. On a ball, they are at most kSampleTilt times its
/// width apart; the result is 1.5 times that, with the larger of the widths along the two
/// directions `across`.
static inline double sample_tolerance(const SupportShape& shape, const double (*across)[3],
                                      double scale) {
  const double width[2] = {user_width(shape, across[0], scale),
                           user_width(shape, across[1], scale)};
  return 1.5 * kSampleTilt * (width[0] > width[1] ? width[0] : width[1]);
}

}  // namespace winnow::WINNOW_ISA_NAME
