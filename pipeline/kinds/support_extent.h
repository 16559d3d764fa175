#pragma once

// The range of a shape along a direction, and the directions along which extent_of (see kinds.h)
// computes it.

#include "pipeline/kinds/hypotenuse.h"
#include "pipeline/kinds/shape_core.h"

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace winnow {

/// The range of d . x over a shape, and the magnitude of the numbers it was computed from.
struct SupportExtent {
  double low;
  double high;
  double scale;
};

// The two direction types compute the quantities of a direction that extents need; UnitDirection is
// cheaper.

/// A direction of any length.
struct AnyDirection {
  const Eigen::Vector3d& d;

  [[nodiscard]] double length() const noexcept { return d.norm(); }
  [[nodiscard]] Eigen::Vector3d unit() const noexcept { return d.stableNormalized(); }
  /// Length of the component orthogonal to the z axis.
  [[nodiscard]] double across() const noexcept { return hypotenuse(d.x(), d.y()); }
};

/// A unit direction, up to rounding; its squares neither overflow nor underflow.
struct UnitDirection {
  const Eigen::Vector3d& d;

  [[nodiscard]] static double length() noexcept { return 1.0; }
  [[nodiscard]] const Eigen::Vector3d& unit() const noexcept { return d; }
  [[nodiscard]] double across() const noexcept { return std::sqrt(d.x() * d.x() + d.y() * d.y()); }
};

[[nodiscard]] inline SupportExtent symmetric(double reach) noexcept {
  return {-reach, reach, reach};
}

[[nodiscard]] inline SupportExtent rounded(const SupportExtent& core, double rounding) noexcept {
  return {core.low - rounding, core.high + rounding, core.scale + rounding};
}

/// Upper bound on the length of v that neither overflows nor underflows; at most sqrt(3) times the
/// length.
[[nodiscard]] inline double length_bound(const Eigen::Vector3d& v) noexcept {
  constexpr double kMinLength = 1e-150;
  const double length = v.norm();
  return length > kMinLength && length < 1.0 / kMinLength ? length : v.lpNorm<1>();
}

}  // namespace winnow
