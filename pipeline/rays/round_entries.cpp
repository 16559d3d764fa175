#include "pipeline/rays/shape_entries.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace {

using Eigen::Vector3d;

/// How far a point is from a core, and the direction away from it (zero inside).
struct Clearance {
  double distance = 0.0;
  Vector3d away = Vector3d::Zero();
};

/// From the distances out of a core of revolution, along the radius and along z.
[[nodiscard]] Clearance clearance(const Vector3d& p, double radial, double axial) noexcept {
  const double rho = std::hypot(p.x(), p.y());
  const double distance = std::hypot(radial, axial);
  if (distance == 0.0) return {};
  const double share = rho > 0.0 ? radial / rho : 0.0;
  return {distance, Vector3d(share * p.x(), share * p.y(), axial) / distance};
}

struct CylinderCore {
  double radius;
  double half_length;

  [[nodiscard]] Clearance at(const Vector3d& p) const noexcept {
    const double beyond = std::max(std::fabs(p.z()) - half_length, 0.0);
    return clearance(p, std::max(std::hypot(p.x(), p.y()) - radius, 0.0),
                     std::copysign(beyond, p.z()));
  }
};

/// Apex at z = half_length.
struct ConeCore {
  ConeCore(double r, double h) noexcept
      : radius(r),
        half_length(h),
        slant(std::hypot(r, 2.0 * h)),
        sine(r / slant),
        cosine(2.0 * h / slant) {}
  double radius;
  double half_length;
  double slant;
  // Of half the angle at the apex: the outward normal of the side is (cosine, sine) in (rho, z).
  double sine;
  double cosine;

  [[nodiscard]] Clearance at(const Vector3d& p) const noexcept {
    const double rho = std::hypot(p.x(), p.y());
    const double depth = half_length - p.z();
    if (p.z() < -half_length && rho <= radius) return clearance(p, 0.0, p.z() + half_length);
    const double height = cosine * rho - sine * depth;
    if (height <= 0.0 && p.z() >= -half_length) return {};
    const double along = sine * rho + cosine * depth;
    if (along < 0.0) return clearance(p, rho, -depth);
    if (along > slant) return clearance(p, rho - radius, p.z() + half_length);
    return clearance(p, cosine * height, sine * height);
  }
};

/// Where a ray crosses the double cone: roots of a quadratic form in (x, y, depth below the apex).
class ConeCrossing {
 public:
  ConeCrossing(const LocalRay& ray, const ConeCore& cone) noexcept
      : cone_(cone),
        o_(ray.origin.x(), ray.origin.y(), cone.half_length - ray.origin.z()),
        d_(ray.direction.x(), ray.direction.y(), -ray.direction.z()) {}

  [[nodiscard]] Span span(double speed) const noexcept {
    double a = form(d_, d_);
    double b = form(o_, d_);
    const double c = form(o_, o_);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    // Parallel to a line of the side, and in it.
    if (std::fabs(a) <= kGrazing * speed * speed) a = 0.0;
    if (std::fabs(b) <= kGrazing * speed) b = 0.0;
    if (a == 0.0 && b == 0.0) {
      return c <= kGrazing ? Span{-kInfinity, kInfinity, Vector3d::Zero()} : Span{};
    }
    const double discriminant = b * b - a * c;
    if (discriminant < -kGrazing * speed * speed) return {};
    const double root = std::sqrt(std::max(0.0, discriminant));
    // The root of larger magnitude first: the other one would cancel.
    const double sum = b > 0.0 ? -(b + root) : root - b;
    const double one = a != 0.0 ? sum / a : std::copysign(kInfinity, sum);
    const double other = sum != 0.0 ? c / sum : one;
    const double first = std::min(one, other);
    const double last = std::max(one, other);
    if (a < 0.0) {
      // One crossing of each nappe.
      return d_.z() > 0.0 ? from(polished(last), kInfinity) : from(-kInfinity, polished(first));
    }
    // Both on the same nappe.
    const double finite = std::isfinite(first) ? first : last;
    if (o_.z() + finite * d_.z() < -kGrazing) return {};
    const double in = polished(first);
    return from(in, std::max(in, polished(last)));
  }

 private:
  [[nodiscard]] double form(const Vector3d& u, const Vector3d& v) const noexcept {
    return cone_.cosine * cone_.cosine * (u.x() * v.x() + u.y() * v.y()) -
           cone_.sine * cone_.sine * u.z() * v.z();
  }
  /// Newton's method on the height over the side, which the form has squared.
  [[nodiscard]] double polished(double t) const noexcept {
    for (int step = 0; step < 2 && std::isfinite(t); ++step) {
      const Vector3d p = o_ + t * d_;
      const double rho = std::hypot(p.x(), p.y());
      if (rho == 0.0) break;
      const double slope =
          cone_.cosine * (p.x() * d_.x() + p.y() * d_.y()) / rho - cone_.sine * d_.z();
      const double next = t - (cone_.cosine * rho - cone_.sine * p.z()) / slope;
      if (!(std::fabs(next - t) <= 1e-7 * (1.0 + std::fabs(t)))) break;
      t = next;
    }
    return t;
  }
  [[nodiscard]] Span from(double in, double out) const noexcept {
    Span span{in, out, Vector3d::Zero()};
    if (!std::isfinite(in)) return span;
    const Vector3d p = o_ + in * d_;
    const double rho = std::hypot(p.x(), p.y());
    if (rho > kGrazing) {
      span.normal = Vector3d(cone_.cosine * p.x() / rho, cone_.cosine * p.y() / rho, cone_.sine);
    }
    return span;
  }

  const ConeCore& cone_;
  Vector3d o_;
  Vector3d d_;
};

/// The distance from a convex core is convex along the ray, so Newton's method from before the
/// entry never passes it: the first point within `rounding` of the core, from t on. Where the ray
/// grazes, each step halves the rest; the number of steps is what a double can be halved.
template <typename Core>
void meet_rounded(const LocalRay& ray, const Core& core, double rounding, double t,
                  FirstEntry& entry) noexcept {
  constexpr int kMaxSteps = 200;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const bool begins = t <= ray.low;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Clearance clear = core.at(ray.at(t));
    const double rest = clear.distance - rounding;
    const double rate = clear.away.dot(ray.direction);
    const double next = rate < 0.0 ? t - rest / rate : t;
    if (rest <= kGrazing || !(next > t)) {
      if (rest > 2.0 * kGrazing && !(rate < 0.0)) return;
      // A grazing entry is found to half of the digits only: one into a flat part stands.
      if (entry.found && !(rate < -1e-6 * ray.speed)) return;
      const bool inside = begins && step == 0 && rest < 0.0;
      entry.meet(ray, {inside ? -kInfinity : t, kInfinity, clear.away});
      return;
    }
    t = next;
  }
}

[[nodiscard]] Span slab_span(const LocalRay& ray, double low, double high) noexcept {
  PlaneClip clip(ray);
  clip.below(Vector3d::UnitZ(), high);
  clip.below(-Vector3d::UnitZ(), -low);
  return clip.span();
}

[[nodiscard]] FirstEntry enter_axis(const LocalRay& ray, double half_length,
                                    double radius) noexcept {
  FirstEntry entry;
  entry.meet(ray, capsule_span(ray, {0.0, 0.0, -half_length}, {0.0, 0.0, half_length}, radius));
  return entry;
}

}  // namespace

FirstEntry enter(const LocalRay& ray, const SphereShape& sphere, double scale) noexcept {
  FirstEntry entry;
  entry.meet(ray, ball_span(ray, Vector3d::Zero(), scale * sphere.radius));
  return entry;
}

FirstEntry enter(const LocalRay& ray, const CapsuleShape& capsule, double scale) noexcept {
  return enter_axis(ray, scale * capsule.half_length, scale * capsule.radius);
}

FirstEntry enter(const LocalRay& ray, const CylinderShape& cylinder, double scale) noexcept {
  const double radius = scale * cylinder.radius;
  const double half = scale * cylinder.half_length;
  const double rounding = scale * cylinder.rounding;
  if (radius == 0.0) return enter_axis(ray, half, rounding);
  FirstEntry entry;
  const auto meet = [&](double r, double h) {
    entry.meet(ray, common(tube_span(ray, r), slab_span(ray, -h, h)));
  };
  if (rounding == 0.0) {
    meet(radius, half);
    return entry;
  }
  const Span hull =
      common(tube_span(ray, radius + rounding), slab_span(ray, -half - rounding, half + rounding));
  if (hull.is_empty()) return entry;
  meet(radius + rounding, half);
  meet(radius, half + rounding);
  meet_rounded(ray, CylinderCore{radius, half}, rounding, std::max(hull.in, ray.low), entry);
  return entry;
}

FirstEntry enter(const LocalRay& ray, const ConeShape& cone, double scale) noexcept {
  const double radius = scale * cone.radius;
  const double half = scale * cone.half_length;
  const double rounding = scale * cone.rounding;
  if (radius == 0.0) return enter_axis(ray, half, rounding);
  FirstEntry entry;
  const ConeCore core(radius, half);
  if (rounding == 0.0) {
    const Span sides =
        half > 0.0 ? ConeCrossing(ray, core).span(ray.speed) : tube_span(ray, radius);
    entry.meet(ray, common(slab_span(ray, -half, half), sides));
    return entry;
  }
  const Span hull =
      common(tube_span(ray, radius + rounding), slab_span(ray, -half - rounding, half + rounding));
  if (hull.is_empty()) return entry;
  // Its base, thickened, is what a ray can graze along.
  entry.meet(ray, common(tube_span(ray, radius), slab_span(ray, -half - rounding, -half)));
  meet_rounded(ray, core, rounding, std::max(hull.in, ray.low), entry);
  return entry;
}

}  // namespace winnow
