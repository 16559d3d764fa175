#include "pipeline/scene/queries/box_path.h"

#include <winnow/core/volumes.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

using Eigen::Vector3d;

/// A piece is at most this many times as long as the distance from the start to its beginning.
constexpr double kPieceGrowth = 0x1p10;
constexpr int kMaxPieces = 5;
/// Slightly below the range of float.
constexpr double kFarthest = 0x1p120;

}  // namespace

BoxPath::BoxPath(const mid::Box3& box, const Vector3d& origin, const double direction[3],
                 double max_t) noexcept
    : box_(box.moved(-origin)) {
  const Vector3d given = Vector3d::Map(direction);
  std::frexp(given.cwiseAbs().maxCoeff(), &exponent_);
  for (int i = 0; i < 3; ++i) step_[i] = std::ldexp(given[i], -exponent_);
  last_ = std::ldexp(max_t, exponent_);
  reach_ = box_.largest();
  rounded_reach_ = std::max(reach_, box.largest());
}

bool BoxPath::next() noexcept {
  if (is_rest_ || (pieces_ != 0 && to_ >= last_)) return false;
  from_ = to_;
  to_ = std::min(last_, kPieceGrowth * std::max({reach_, from_, 1.0}));
  is_rest_ = pieces_ == kMaxPieces || !(reach_ + to_ < kFarthest);
  ++pieces_;
  if (is_rest_) to_ = last_;
  return true;
}

double BoxPath::begin() const noexcept {
  return std::ldexp(from_, -exponent_);
}

/// Covers the rounding of the direction to float, the rounding of coordinates, and rays that miss a
/// shape by no more than rounding, which cast_ray reports as hits.
double BoxPath::slack(double end) const noexcept {
  return 0x1p-23 * (end - from_) + 0x1p-47 * (rounded_reach_ + end);
}

mid::Box3 BoxPath::at(double path) const noexcept {
  return box_.moved(path * step_);
}

BoxCast BoxPath::cast(double limit) const noexcept {
  const double end = std::clamp(std::ldexp(limit, exponent_), from_, to_);
  const mid::Box3 start = at(from_).grown(slack(to_));
  BoxCast cast;
  cast.box = Aabb::outward(start.min, start.max);
  cast.direction = step_.cast<float>();
  cast.max_t = round_up((end - from_) * (1.0 + 0x1p-50));
  return cast;
}

Aabb BoxPath::rest(double limit) const noexcept {
  const double end = std::clamp(std::ldexp(limit, exponent_), from_, to_);
  mid::Box3 sum = at(from_);
  for (int i = 0; i < 3; ++i) {
    if (step_[i] == 0.0) continue;
    const double path = end * step_[i];
    sum.min[i] = std::min(sum.min[i], box_.min[i] + path);
    sum.max[i] = std::max(sum.max[i], box_.max[i] + path);
  }
  // The rounding error of a finite path is relative to its end points.
  for (int i = 0; i < 3; ++i) {
    const double slack = 0x1p-47 * (rounded_reach_ + from_);
    sum.min[i] -= slack + 0x1p-47 * std::abs(sum.min[i]);
    sum.max[i] += slack + 0x1p-47 * std::abs(sum.max[i]);
  }
  Aabb box;
  constexpr float kMaxFloat = std::numeric_limits<float>::max();
  box.min = round_down(sum.min).min(Vec3f::constant(kMaxFloat));
  box.max = round_up(sum.max).max(Vec3f::constant(-kMaxFloat));
  return box;
}

}  // namespace winnow
