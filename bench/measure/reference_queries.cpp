// Evaluates one query on one box in double, with an error margin. comparison.cpp uses it as the
// reference for query engines.

#include "bench/measure/reference_queries.h"

#include <winnow/core/eigen.h>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

namespace winnow::bench {
namespace {

using Double3 = Eigen::Vector3d;

struct DoubleBox {
  Double3 min;
  Double3 max;

  explicit DoubleBox(const Aabb& box) : min(box.min.cast<double>()), max(box.max.cast<double>()) {}

  [[nodiscard]] double distance(const Double3& point) const {
    return (min - point).cwiseMax(point - max).cwiseMax(0.0).norm();
  }
  /// Greatest finite coordinate by magnitude; rounding errors are relative to it.
  [[nodiscard]] double size() const {
    double most = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double end : {min[axis], max[axis]}) {
        if (std::isfinite(end)) most = std::max(most, std::abs(end));
      }
    }
    return most;
  }
};

struct Line {
  Double3 origin;
  Double3 direction;
  double min_t;
  double max_t;
};

template <typename Moving>
Line line_of(const Moving& moving, const Double3& origin) {
  return {origin, moving.direction.template cast<double>(), static_cast<double>(moving.min_t),
          static_cast<double>(moving.max_t)};
}

/// The interval of a line inside of a box: computed, surely inside, and possibly inside.
struct LineInterval {
  double enter_surely;
  double leave_surely;
  double enter_maybe;
  double leave_maybe;
  double enter;
  double leave;
};

LineInterval interval_in(const DoubleBox& box, const Line& line, double tolerance) {
  LineInterval s{line.min_t, line.max_t, line.min_t, line.max_t, line.min_t, line.max_t};
  for (int axis = 0; axis < 3; ++axis) {
    const double d = line.direction[axis];
    const double o = line.origin[axis];
    if (d == 0.0) {
      if (box.min[axis] <= o && o <= box.max[axis]) continue;
      s.leave = s.leave_surely = s.leave_maybe = -1.0;
      continue;
    }
    const double first = d > 0.0 ? box.min[axis] : box.max[axis];
    const double second = d > 0.0 ? box.max[axis] : box.min[axis];
    const auto error = [&](double end) {
      return std::isfinite(end) ? tolerance * (std::abs(end) + std::abs(o)) / std::abs(d) : 0.0;
    };
    const double a = (first - o) / d;
    const double b = (second - o) / d;
    s.enter = std::max(s.enter, a);
    s.leave = std::min(s.leave, b);
    s.enter_surely = std::max(s.enter_surely, a + error(first));
    s.leave_surely = std::min(s.leave_surely, b - error(second));
    s.enter_maybe = std::max(s.enter_maybe, a - error(first));
    s.leave_maybe = std::min(s.leave_maybe, b + error(second));
  }
  return s;
}

Verdict judge_line(const DoubleBox& box, const Line& line, double tolerance) {
  const LineInterval s = interval_in(box, line, tolerance);
  return {s.enter_maybe <= s.leave_maybe, s.enter_surely <= s.leave_surely, s.enter};
}

/// A swept box touches a box if its origin touches the Minkowski sum of the two.
Verdict judge_cast(const DoubleBox& box, const BoxCast& cast, double tolerance) {
  DoubleBox sum = box;
  sum.min -= as_eigen(cast.box.max).cast<double>();
  sum.max -= as_eigen(cast.box.min).cast<double>();
  return judge_line(sum, line_of(cast, Double3::Zero()), tolerance);
}

/// The distance of a moving point from a box is a convex function of time. Ternary search finds its
/// minimum, and bisection before it the first time at which it equals the radius.
Verdict judge_cast(const DoubleBox& box, const SphereCast& cast, double tolerance) {
  const Line line = line_of(cast, cast.sphere.center.cast<double>());
  const auto radius = static_cast<double>(cast.sphere.radius);
  DoubleBox grown = box;
  grown.min.array() -= radius;
  grown.max.array() += radius;
  const LineInterval s = interval_in(grown, line, tolerance);
  if (s.enter_maybe > s.leave_maybe) return {};
  const auto gap = [&](double t) {
    return box.distance(line.origin + t * line.direction) - radius;
  };
  double low = s.enter;
  double high = std::max(s.enter, s.leave);
  for (int step = 0; step < 200; ++step) {
    const double third = (high - low) / 3.0;
    if (gap(low + third) <= gap(high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  const double least = gap(low);
  const double margin = tolerance * (box.size() + line.origin.cwiseAbs().maxCoeff() + radius);
  double before = s.enter;
  double after = low;
  if (gap(before) <= 0.0) after = before;
  for (int step = 0; step < 100 && before < after; ++step) {
    const double middle = 0.5 * (before + after);
    (gap(middle) <= 0.0 ? after : before) = middle;
  }
  return {least <= margin, least <= -margin, after};
}

Verdict judge_region(const DoubleBox& box, const Sphere& ball, double tolerance) {
  const Double3 center = ball.center.cast<double>();
  const auto radius = static_cast<double>(ball.radius);
  const double gap = box.distance(center) - radius;
  const double margin = tolerance * (box.size() + center.cwiseAbs().maxCoeff() + radius);
  return {gap <= margin, gap <= -margin, 0.0};
}

Verdict judge_region(const DoubleBox& box, const Frustum& frustum, double tolerance) {
  Verdict verdict{true, true, 0.0};
  for (int axis = 0; axis < 3; ++axis) {
    const bool apart = box.min[axis] > static_cast<double>(frustum.bounds.max[axis]) ||
                       box.max[axis] < static_cast<double>(frustum.bounds.min[axis]);
    if (apart) return {};
  }
  for (const Plane& plane : frustum.planes) {
    const Double3 normal = plane.normal.cast<double>();
    const auto offset = static_cast<double>(plane.offset);
    const Double3 corner = (normal.array() > 0.0).select(box.max, box.min);
    // A zero component of the normal must give zero, also for an infinite end of the box.
    const Double3 terms = (normal.array() == 0.0).select(0.0, normal.cwiseProduct(corner));
    const double depth = terms.sum() + offset;
    const double margin = tolerance * (terms.cwiseAbs().sum() + std::abs(offset));
    verdict.possible = verdict.possible && depth >= -margin;
    verdict.certain = verdict.certain && depth >= margin;
  }
  return verdict;
}

}  // namespace

Verdict ReferenceQueries::verdict(const QuerySet& set, std::size_t question, std::uint32_t row,
                                  double tolerance) const {
  const DoubleBox box(boxes_[row]);
  if (!set.rays.empty()) {
    const Ray& ray = set.rays[question];
    return judge_line(box, line_of(ray, ray.origin.cast<double>()), tolerance);
  }
  if (!set.casts.empty()) {
    return std::visit([&](const auto& cast) { return judge_cast(box, cast, tolerance); },
                      set.casts[question]);
  }
  if (!set.regions.empty()) {
    return std::visit([&](const auto& region) { return judge_region(box, region, tolerance); },
                      set.regions[question]);
  }
  if (set.query_type == QueryType::nearest) {
    return {true, true, box.distance(set.boxes[question].min.cast<double>())};
  }
  const bool overlaps = boxes_[row].overlaps(set.boxes[question]);
  return {overlaps, overlaps, 0.0};
}

}  // namespace winnow::bench
