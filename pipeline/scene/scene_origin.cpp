#include "pipeline/scene/scene_origin.h"

#include "core/sort/order_statistics.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace {

/// Relative spacing of floats, and the largest acceptable spacing as a share of a radius.
constexpr double kFloatStep = 0x1p-23;
constexpr double kFineStep = 0x1p-10;
/// The distance to the origin must exceed the spread of the bodies by this factor before all boxes
/// are computed again.
constexpr double kWorthMoving = 8.0;
/// Beyond this, differences to the origin could overflow floats.
constexpr double kFarthestOrigin = 0x1p120;

}  // namespace

void BodySample::add(const double position[3], double radius) noexcept {
  if (is_full() || !std::isfinite(radius)) return;
  for (std::size_t axis = 0; axis < 3; ++axis) position_[axis][count_] = position[axis];
  radius_[count_++] = radius;
}

Eigen::Vector3d BodySample::origin(const Eigen::Vector3d& current) const noexcept {
  if (count_ == 0) return current;
  const double radius = median_of(radius_, count_);
  Eigen::Vector3d middle;
  double spread = radius;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double at = median_of(position_[axis], count_);
    std::array<double, kMaxSamples> apart;
    for (std::size_t i = 0; i < count_; ++i) apart[i] = std::abs(position_[axis][i] - at);
    spread = std::max(spread, median_of(apart, count_));
    middle[static_cast<Eigen::Index>(axis)] = at;
  }
  const double away = (middle - current).cwiseAbs().maxCoeff();
  const bool is_coarse = away * kFloatStep > radius * kFineStep;
  if (!is_coarse || !(away > kWorthMoving * spread)) return current;
  if (!(middle.cwiseAbs().maxCoeff() < kFarthestOrigin)) return current;
  int exponent = 0;
  std::frexp(spread, &exponent);
  const double step = std::ldexp(1.0, exponent);
  return (middle / step).array().round() * step;
}

}  // namespace winnow
