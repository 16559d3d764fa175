#pragma once

#include "pipeline/solver/core.h"
#include "pipeline/solver/simplex.h"

namespace winnow::solver {

struct GjkResult {
  Simplex simplex;
  /// From a to b between the closest points found; zero length where `contact`.
  Vec between = Vec::Zero();
  /// Length of `between`, and the best separation along any direction that was tried: the distance
  /// of the cores lies between the two, roundings aside.
  double upper = 0.0;
  double lower = 0.0;
  /// The unit direction of `lower`.
  Vec axis = Vec::Zero();
  /// The cores share a point, as far as double can tell.
  bool contact = false;
  /// Stopped early: `lower` is above `enough`.
  bool far = false;
  /// Ended by the bound on iterations.
  bool bounded = false;
};

/// Distance of two bounded cores (Gilbert, Johnson, Keerthi, 1988) with simplices reduced by signed
/// volumes. Ends when the gap between the distance and its supporting plane is relatively as small
/// as doubles can make it, or no progress is made; in at most 64 iterations for polytopes of any
/// size that are not degenerate, and never in more than 256. `start`: where to look first, from a
/// to b. `noise`: lengths that cannot be told from zero.
[[nodiscard]] GjkResult gjk(const Core& a, const Core& b, const Vec& start, double noise,
                            double enough) noexcept;

}  // namespace winnow::solver
