// Reference implementation of casts against one box: rays and boxes in exact arithmetic, spheres
// and capsules in long double with a search over time.

#include "tests/support/cast_reference.h"
#include <winnow/core/eigen.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "tests/support/exact.h"

namespace winnow::test {
namespace {

using Real = long double;
using Point = Eigen::Vector3<Real>;

constexpr float kLargest = std::numeric_limits<float>::max();
constexpr double kInf = std::numeric_limits<double>::infinity();

// (high - low) / divisor, with divisor > 0.
struct Fraction {
  float high = 0.0F;
  float low = 0.0F;
  float divisor = 1.0F;

  // Each of the two steps rounds once; the range of double suffices.
  [[nodiscard]] double value() const {
    return (static_cast<double>(high) - static_cast<double>(low)) / static_cast<double>(divisor);
  }
};

[[nodiscard]] bool exactly_at_most(const Fraction& a, const Fraction& b) {
  const Exact x = Exact(static_cast<double>(a.high)) - static_cast<double>(a.low);
  const Exact y = Exact(static_cast<double>(b.high)) - static_cast<double>(b.low);
  return x * static_cast<double>(b.divisor) <= y * static_cast<double>(a.divisor);
}

// The times at which a moving box enters and leaves a box at rest, for each axis.
struct Slabs {
  std::array<Fraction, 4> entries{};
  std::array<Fraction, 4> exits{};
  std::size_t entry_count = 0;
  std::size_t exit_count = 0;
  bool apart = false;  // apart on an axis without motion

  Slabs(const BoxCast& cast, const Aabb& box) {
    entries[entry_count++] = {cast.min_t, 0.0F, 1.0F};
    if (std::isfinite(cast.max_t)) exits[exit_count++] = {cast.max_t, 0.0F, 1.0F};
    for (int k = 0; k < 3; ++k) {
      const float d = cast.direction[k];
      if (d > 0.0F) {
        entries[entry_count++] = {box.min[k], cast.box.max[k], d};
        exits[exit_count++] = {box.max[k], cast.box.min[k], d};
      } else if (d < 0.0F) {
        entries[entry_count++] = {cast.box.min[k], box.max[k], -d};
        exits[exit_count++] = {cast.box.max[k], box.min[k], -d};
      } else {
        apart = apart || box.min[k] > cast.box.max[k] || cast.box.min[k] > box.max[k];
      }
    }
  }
};

// A line against the slabs of a box that is grown by `slack` on each axis, in double.
struct Window {
  double entry = -kInf;
  double exit = kInf;
  bool apart = false;

  Window(const BoxCast& cast, const Aabb& box, const Eigen::Vector3d& slack)
      : entry(static_cast<double>(cast.min_t)), exit(static_cast<double>(cast.max_t)) {
    for (int k = 0; k < 3; ++k) {
      const double d = std::abs(static_cast<double>(cast.direction[k]));
      double near_gap = static_cast<double>(box.min[k]) - static_cast<double>(cast.box.max[k]);
      double far_gap = static_cast<double>(box.max[k]) - static_cast<double>(cast.box.min[k]);
      near_gap -= slack[k];
      far_gap += slack[k];
      if (cast.direction[k] < 0.0F) {
        std::swap(near_gap, far_gap);
        near_gap = -near_gap;
        far_gap = -far_gap;
      }
      if (d == 0.0) {
        if (near_gap > 0.0 || far_gap < 0.0) apart = true;
        continue;
      }
      entry = std::max(entry, near_gap / d);
      exit = std::min(exit, far_gap / d);
    }
  }
  // Tolerates the rounding of double.
  [[nodiscard]] bool is_open() const {
    return !apart && entry <= exit + 1e-15 * (std::abs(entry) + std::abs(exit));
  }
};

CastTruth truth_of_slabs(const BoxCast& cast, const Aabb& box) {
  const Slabs slabs(cast, box);
  double entry = -kInf;
  double exit = kInf;
  for (std::size_t i = 0; i < slabs.entry_count; ++i) {
    entry = std::max(entry, slabs.entries[i].value());
  }
  for (std::size_t i = 0; i < slabs.exit_count; ++i) {
    exit = std::min(exit, slabs.exits[i].value());
  }
  const double margin = 1e-15 * (std::abs(entry) + std::abs(exit));
  CastTruth truth;
  if (slabs.apart || entry > exit + margin) {
    truth.must = false;
  } else if (entry < exit - margin || exit == kInf) {
    truth.must = true;
  } else {
    truth.must = true;
    for (std::size_t i = 0; i < slabs.entry_count; ++i) {
      for (std::size_t j = 0; j < slabs.exit_count; ++j) {
        truth.must = truth.must && exactly_at_most(slabs.entries[i], slabs.exits[j]);
      }
    }
  }
  truth.may = truth.must;
  if (!truth.may) {
    Eigen::Vector3d slack;
    for (int k = 0; k < 3; ++k) {
      slack[k] = 1e-14 * static_cast<double>(
                             std::max({std::abs(box.min[k]), std::abs(box.max[k]),
                                       std::abs(cast.box.min[k]), std::abs(cast.box.max[k])}));
    }
    truth.may = Window(cast, box, slack).is_open();
  }
  truth.earliest = entry * (1.0 - 1e-14);
  truth.latest = entry * (1.0 + 1e-14);
  return truth;
}

// A moving capsule and its distance from a box at each time, which is convex in time.
class Approach {
 public:
  Approach(const CapsuleCast& cast, const Aabb& box)
      : a_(cast.capsule.a.cast<Real>()),
        b_(cast.capsule.b.cast<Real>()),
        d_(cast.direction.cast<Real>()),
        box_(box) {}

  [[nodiscard]] Real square(double time) const {
    const Point way = d_ * static_cast<Real>(time);
    return segment_box_square(a_ + way, b_ + way, box_);
  }

  // Returns the time of the least distance in [begin, end], or any time at which the distance is at
  // most `enough`, by golden-section search. If rounding decides between two equal values, the
  // discarded part can contain only values that are smaller by rounding, because the distance is
  // convex in time.
  [[nodiscard]] double nearest_time(double begin, double end, Real enough) const {
    const Real limit = enough > 0.0L ? enough * enough : 0.0L;
    if (square(begin) <= limit) return begin;
    constexpr double kPart = 0.38196601125010515;
    double lo = begin;
    double hi = end;
    double x = lo + kPart * (hi - lo);
    double y = hi - kPart * (hi - lo);
    Real at_x = square(x);
    Real at_y = square(y);
    while (lo < x && x < y && y < hi) {
      if (at_x <= at_y) {
        if (at_x <= limit) return x;
        hi = y;
        y = x;
        at_y = at_x;
        x = lo + kPart * (hi - lo);
        at_x = square(x);
      } else {
        if (at_y <= limit) return y;
        lo = x;
        x = y;
        at_x = at_y;
        y = hi - kPart * (hi - lo);
        at_y = square(y);
      }
    }
    double best = begin;
    for (const double t : {lo, x, y, hi, end}) {
      if (square(t) < square(best)) best = t;
    }
    return best;
  }

  // Returns the time between `outside` and `within`, in either order, at which the distance becomes
  // `reach`.
  [[nodiscard]] double touch_time(double outside, double within, Real reach) const {
    constexpr std::uint64_t kClose = 256;  // doubles
    const Real limit = reach * reach;
    if (square(outside) <= limit) return outside;
    std::uint64_t out = std::bit_cast<std::uint64_t>(outside);
    std::uint64_t in = std::bit_cast<std::uint64_t>(within);
    while (std::max(in, out) - std::min(in, out) > kClose) {
      const std::uint64_t middle = std::midpoint(in, out);
      (square(std::bit_cast<double>(middle)) <= limit ? in : out) = middle;
    }
    return std::bit_cast<double>(in);
  }

 private:
  Point a_;
  Point b_;
  Point d_;
  Aabb box_;
};

CastTruth truth_of_round(const CapsuleCast& cast, const Aabb& box, double tolerance) {
  const Capsule& capsule = cast.capsule;
  const auto radius = static_cast<double>(capsule.radius);
  const BoxCast around{
      {capsule.a.min(capsule.b), capsule.a.max(capsule.b)}, cast.direction, cast.min_t, cast.max_t};
  const auto window = [&](double size) {
    const double reach = radius + (2.0 * tolerance + 1e-13) * size;
    return Window(around, box, Eigen::Vector3d::Constant(reach));
  };
  double size =
      std::max({magnitude(box), static_cast<double>(as_eigen(capsule.a).cwiseAbs().maxCoeff()),
                static_cast<double>(as_eigen(capsule.b).cwiseAbs().maxCoeff()), radius});
  // The length of the motion to the box counts as well: magnitude() leaves out infinite ends, but a
  // motion to such an end is as long as the range of float.
  size = std::max(size, window(size).entry *
                            static_cast<double>(as_eigen(cast.direction).cwiseAbs().maxCoeff()));
  const double slack = tolerance * size;
  const Window open = window(size);
  if (!open.is_open()) return {};
  const double begin = open.entry;
  const double end = std::max(begin, std::min(open.exit, 1e200));
  const Approach approach(cast, box);
  const auto r = static_cast<Real>(radius);
  const double best = approach.nearest_time(begin, end, r - static_cast<Real>(slack));
  const Real least = std::sqrt(approach.square(best));
  CastTruth truth;
  truth.must = least <= r - static_cast<Real>(1e-15 * size);
  truth.may = truth.must || least <= r + static_cast<Real>(slack);
  if (!truth.may) return truth;
  const Real inner = r - static_cast<Real>(slack);
  const Real outer = r + static_cast<Real>(slack);
  truth.earliest = approach.touch_time(begin, best, outer) * (1.0 - 1e-14);
  // If the capsule only grazes the box, any time of contact is accepted.
  truth.latest = least <= inner ? approach.touch_time(begin, best, inner)
                                : approach.touch_time(end, best, outer);
  truth.latest *= 1.0 + 1e-14;
  return truth;
}

}  // namespace

Aabb finite(Aabb box) {
  box.min = as_eigen(box.min).cwiseMax(-kLargest).cwiseMin(kLargest);
  box.max = as_eigen(box.max).cwiseMax(-kLargest).cwiseMin(kLargest);
  return box;
}

double magnitude(const Aabb& box) {
  double size = 0.0;
  for (int k = 0; k < 3; ++k) {
    for (const float end : {box.min[k], box.max[k]}) {
      if (std::abs(end) < kLargest) size = std::max(size, std::abs(static_cast<double>(end)));
    }
  }
  return size;
}

Real segment_box_square(const Point& a, const Point& b, const Aabb& box) {
  const Point low = box.min.cast<Real>();
  const Point high = box.max.cast<Real>();
  const Point u = b - a;
  const auto excess = [&](Real s) -> Point {
    const Point p = a + s * u;
    return (p - high).cwiseMax(0.0L) - (low - p).cwiseMax(0.0L);
  };
  if (u.isZero(0.0L)) return excess(0.0L).squaredNorm();
  const auto slope = [&](Real s) { return excess(s).dot(u); };
  // The slope of the squared distance is piecewise linear and never falls.
  Real begin = 0.0L;
  Real end = 1.0L;
  if (slope(begin) >= 0.0L) return excess(begin).squaredNorm();
  if (slope(end) <= 0.0L) return excess(end).squaredNorm();
  for (int k = 0; k < 3; ++k) {
    if (u[k] == 0.0L) continue;
    for (const Real face : {low[k], high[k]}) {
      const Real s = (face - a[k]) / u[k];
      if (s <= begin || s >= end) continue;
      (slope(s) < 0.0L ? begin : end) = s;
    }
  }
  const Real rise = slope(end) - slope(begin);
  const Real s = rise > 0.0L ? begin - slope(begin) * (end - begin) / rise : begin;
  return std::min(
      {excess(s).squaredNorm(), excess(begin).squaredNorm(), excess(end).squaredNorm()});
}

bool is_first_touch(float t, const CastTruth& truth) {
  if (!(static_cast<double>(t) <= truth.latest)) return false;
  if (t == kLargest) return true;
  return static_cast<double>(std::nextafter(t, kLargest)) >= truth.earliest;
}

CastTruth truth_of(const Cast& cast, const Aabb& given) {
  const Aabb box = finite(given);
  if (const auto* ray = std::get_if<Ray>(&cast)) {
    return truth_of_slabs({{ray->origin, ray->origin}, ray->direction, ray->min_t, ray->max_t},
                          box);
  }
  if (const auto* box_cast = std::get_if<BoxCast>(&cast)) return truth_of_slabs(*box_cast, box);
  if (const auto* ball = std::get_if<SphereCast>(&cast)) {
    const Capsule capsule{ball->sphere.center, ball->sphere.center, ball->sphere.radius};
    return truth_of_round({capsule, ball->direction, ball->min_t, ball->max_t}, box, 1e-12);
  }
  return truth_of_round(std::get<CapsuleCast>(cast), box, 1e-6);
}

}  // namespace winnow::test
