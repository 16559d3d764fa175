#pragma once

#include "pipeline/solver/core.h"

#include <limits>

namespace winnow::solver {

/// Two points, one on each core.
struct ClosestPoints {
  Vec on_a = Vec::Zero();
  Vec on_b = Vec::Zero();
  double square = std::numeric_limits<double>::infinity();
};

/// The closest points of two polytopes that do not overlap, by trying features: corners against
/// faces, edges against edges. `axis` is unit, from a to b, along which the cores are at least
/// `lower` apart, and they are at most `upper` apart: only features that reach into the slabs in
/// which the closest points then lie are tried. O(features of a x features of b in those slabs);
/// false if that is above a bound of some millions.
bool closest_features(const Core& a, const Core& b, const Vec& axis, double lower, double upper,
                      double noise, ClosestPoints& points) noexcept;

}  // namespace winnow::solver
