// Ray tests for ellipsoids, user shapes and kinds without a function of their own: conservative
// advancement with GJK (solver/gjk.h), and a closed form for ellipsoids without rounding whose
// radii are not near 0.

#include "pipeline/rays/shape_entries.h"
#include "pipeline/solver/gjk.h"

#include <algorithm>
#include <limits>

namespace winnow {
namespace {

using Eigen::Vector3d;

constexpr double kNoEnd = std::numeric_limits<double>::infinity();

/// A plane between a point and a core: its normal and the point's distance from it.
struct Foreground {
  double distance = 0.0;
  Vector3d normal = Vector3d::Zero();
  bool inside = false;
};

class SupportTarget {
 public:
  SupportTarget(const ShapeCore& core, double scale) noexcept {
    body_.kind = core.kind;
    body_.half = scale * core.half;
    body_.corners = core.corners;
    body_.farthest = core.support;
    body_.scale = solver::Scale::by(scale);
  }

  [[nodiscard]] Foreground seen_from(const Vector3d& point) noexcept {
    point_.center = point;
    const Vector3d start = point.isZero(0.0) ? Vector3d(Vector3d::UnitX()) : Vector3d(-point);
    const solver::GjkResult found = solver::gjk(point_, body_, start, {.noise = kGrazing});
    if (found.contact) return {0.0, Vector3d::Zero(), true};
    return {found.lower, -found.axis, false};
  }

 private:
  solver::Core point_;
  solver::Core body_;
};

}  // namespace

// Advances the ray from one separating plane to the next; the core is behind each plane, so no
// step passes the entry (van den Bergen, "Ray casting against general convex objects with
// application to continuous collision detection", 2004). If a ray grazes, each step only halves
// the remaining distance.
FirstEntry enter_core(const LocalRay& ray, const ShapeCore& core, double scale) noexcept {
  constexpr int kMaxSteps = 200;
  const double rounding = scale * core.rounding;
  FirstEntry entry;
  const RaySpan ball =
      ball_span(ray, Vector3d::Zero(), scale * (core.half.norm() + core.support.radius) + rounding);
  if (ball.is_empty() || ball.out < ray.low) return entry;
  SupportTarget target(core, scale);
  double t = std::max(ball.in, ray.low);
  Vector3d normal = Vector3d::Zero();
  for (int step = 0; step < kMaxSteps; ++step) {
    const Foreground seen = target.seen_from(ray.at(t));
    const double rest = seen.distance - rounding;
    if (!seen.inside) normal = seen.normal;
    const double rate = normal.dot(ray.direction);
    if (!seen.inside && rest > 4.0 * kGrazing && !(rate < 0.0)) return entry;
    const double next = rate < 0.0 ? t - rest / rate : t;
    if (!seen.inside && rest > kGrazing && next > t) {
      t = next;
      continue;
    }
    const bool begins = step == 0 && t <= ray.low && (seen.inside || rest < 0.0);
    entry.merge_span(ray, {begins ? -kNoEnd : t, kNoEnd, normal});
    return entry;
  }
  return entry;
}

FirstEntry enter(const LocalRay& ray, const EllipsoidShape& ellipsoid, double scale) noexcept {
  constexpr double kThin = 1e-12;
  const Vector3d radius = scale * as_eigen(ellipsoid.radius);
  if (ellipsoid.rounding > 0.0 || !(radius.minCoeff() > kThin)) {
    return enter_core(ray, ShapeCore::of_support(ShapeKind::ellipsoid, support_core(ellipsoid)),
                      scale);
  }
  LocalRay stretched = ray;
  stretched.origin = ray.origin.cwiseQuotient(radius);
  stretched.direction = ray.direction.cwiseQuotient(radius);
  RaySpan span = ball_span(stretched, Vector3d::Zero(), 1.0);
  span.normal = span.normal.cwiseQuotient(radius).stableNormalized();
  FirstEntry entry;
  entry.merge_span(ray, span);
  return entry;
}

}  // namespace winnow
