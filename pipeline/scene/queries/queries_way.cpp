#include "pipeline/scene/queries/queries_way.h"
#include <winnow/core/rounding.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Longer by this factor is a piece than the distance from where it begins.
constexpr double kStretch = 0x1p10;
constexpr int kMostPieces = 5;
/// Floats end a little after this.
constexpr double kFarthest = 0x1p120;

}  // namespace

BoxWay::BoxWay(const PreciseBox& box, const double direction[3], double max_t) noexcept
    : box_(box) {
  const Vector3d given = Vector3d::Map(direction);
  std::frexp(given.cwiseAbs().maxCoeff(), &exponent_);
  for (int i = 0; i < 3; ++i) step_[i] = std::ldexp(given[i], -exponent_);
  last_ = std::ldexp(max_t, exponent_);
  reach_ = std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff());
}

bool BoxWay::next() noexcept {
  if (is_rest_ || (pieces_ != 0 && to_ >= last_)) return false;
  from_ = to_;
  to_ = std::min(last_, kStretch * std::max({reach_, from_, 1.0}));
  is_rest_ = pieces_ == kMostPieces || !(reach_ + to_ < kFarthest);
  ++pieces_;
  if (is_rest_) to_ = last_;
  return true;
}

double BoxWay::begin() const noexcept {
  return std::ldexp(from_, -exponent_);
}

/// Rounding of the direction to float, and of coordinates; cast_ray takes rays that pass by no
/// farther than rounding.
double BoxWay::slack(double end) const noexcept {
  return 0x1p-23 * (end - from_) + 0x1p-47 * (reach_ + end);
}

PreciseBox BoxWay::at(double way) const noexcept {
  return {box_.min + way * step_, box_.max + way * step_};
}

BoxCast BoxWay::cast(double limit) const noexcept {
  const double end = std::clamp(std::ldexp(limit, exponent_), from_, to_);
  const PreciseBox start = at(from_).grown(slack(to_));
  BoxCast cast;
  cast.box = Aabb::outward(start.min, start.max);
  cast.direction = step_.cast<float>();
  cast.max_t = round_up((end - from_) * (1.0 + 0x1p-50));
  return cast;
}

Aabb BoxWay::rest(double limit) const noexcept {
  const double end = std::clamp(std::ldexp(limit, exponent_), from_, to_);
  PreciseBox sum = at(from_);
  for (int i = 0; i < 3; ++i) {
    if (step_[i] == 0.0) continue;
    const double way = end * step_[i];
    sum.min[i] = std::min(sum.min[i], box_.min[i] + way);
    sum.max[i] = std::max(sum.max[i], box_.max[i] + way);
  }
  // What is lost of a finite way is as small beside its ends.
  for (int i = 0; i < 3; ++i) {
    const double slack = 0x1p-47 * (reach_ + from_);
    sum.min[i] -= slack + 0x1p-47 * std::abs(sum.min[i]);
    sum.max[i] += slack + 0x1p-47 * std::abs(sum.max[i]);
  }
  Aabb box;
  constexpr float kMost = std::numeric_limits<float>::max();
  box.min = round_down(sum.min).cwiseMin(kMost);
  box.max = round_up(sum.max).cwiseMax(-kMost);
  return box;
}

}  // namespace winnow
