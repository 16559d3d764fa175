// Entry of a ray into each kind of convex shape except ellipsoids and user shapes
// (support_entries.cpp). Sharp shapes are clipped in closed form; rounded cylinders, cones and
// tapered capsules use Newton's method on the distance to the core. Called by shape_rays.cpp.

#include "pipeline/rays/shape_entries.h"
#include "pipeline/kinds/hypotenuse.h"
#include "pipeline/shapes/accurate_cross.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace winnow {
namespace {

using Eigen::Vector3d;

/// Distance of a point from a core, and the direction away from it (zero inside).
struct Clearance {
  double distance = 0.0;
  Vector3d away = Vector3d::Zero();
};

/// Clearance from a solid of revolution, given its components along the radius and along z.
[[nodiscard]] Clearance clearance(const Vector3d& p, double radial, double axial) noexcept {
  const double rho = hypotenuse(p.x(), p.y());
  const double distance = hypotenuse(radial, axial);
  if (distance == 0.0) return {};
  const double share = rho > 0.0 ? radial / rho : 0.0;
  return {distance, Vector3d(share * p.x(), share * p.y(), axial) / distance};
}

struct CylinderCore {
  double radius;
  double half_length;

  [[nodiscard]] Clearance at(const Vector3d& p) const noexcept {
    const double beyond = std::max(std::fabs(p.z()) - half_length, 0.0);
    return clearance(p, std::max(hypotenuse(p.x(), p.y()) - radius, 0.0),
                     std::copysign(beyond, p.z()));
  }
};

/// Apex at z = half_length.
struct ConeCore {
  ConeCore(double r, double h) noexcept
      : radius(r),
        half_length(h),
        slant(hypotenuse(r, 2.0 * h)),
        sine(r / slant),
        cosine(2.0 * h / slant) {}
  double radius;
  double half_length;
  double slant;
  // Sine and cosine of half the apex angle. The outward normal of the side is (cosine, sine) in
  // (rho, z).
  double sine;
  double cosine;

  [[nodiscard]] Clearance at(const Vector3d& p) const noexcept {
    const double rho = hypotenuse(p.x(), p.y());
    const double depth = half_length - p.z();
    if (p.z() < -half_length && rho <= radius) return clearance(p, 0.0, p.z() + half_length);
    const double height = cosine * rho - sine * depth;
    if (height <= 0.0 && p.z() >= -half_length) return {};
    const double along = sine * rho + cosine * depth;
    if (along < 0.0) return clearance(p, rho, -depth);
    if (along > slant) return clearance(p, rho - radius, p.z() + half_length);
    return clearance(p, cosine * height, sine * height);
  }

  /// The outward normal of the base or the side at a point of the surface where a ray enters along
  /// `direction`.
  [[nodiscard]] Vector3d outward(const Vector3d& p, const Vector3d& direction) const noexcept {
    const double rho = hypotenuse(p.x(), p.y());
    const double across = rho > 0.0 ? cosine / rho : 0.0;
    const Vector3d side(across * p.x(), across * p.y(), sine);
    const Vector3d base(0.0, 0.0, -1.0);
    if (direction.z() <= 0.0) return side;
    if (!(side.dot(direction) < 0.0)) return base;
    return cosine * rho - sine * (half_length - p.z()) >= -half_length - p.z() ? side : base;
  }
};

/// Signed distance (negative inside) from the convex hull of two balls on the z axis, neither of
/// which contains the other: the balls and the cone tangent to both.
class TaperSurface {
 public:
  TaperSurface(double low_radius, double high_radius, double h) noexcept
      : radius_{low_radius, high_radius},
        half_(h),
        sine_((low_radius - high_radius) / (2.0 * h)),
        cosine_(std::sqrt((1.0 - sine_) * (1.0 + sine_))) {}

  [[nodiscard]] Clearance at(const Vector3d& p) const noexcept {
    const double rho = hypotenuse(p.x(), p.y());
    const double up = p.z() + half_;
    const double along = cosine_ * up - sine_ * rho;
    if (along <= 0.0 || along >= 2.0 * half_ * cosine_) {
      const bool is_low = along <= 0.0;
      const Vector3d from = p + Vector3d(0.0, 0.0, is_low ? half_ : -half_);
      const double distance = from.norm();
      return {distance - radius_[is_low ? 0 : 1],
              distance > 0.0 ? Vector3d(from / distance) : Vector3d(Vector3d::Zero())};
    }
    const double across = rho > 0.0 ? cosine_ / rho : 0.0;
    return {cosine_ * rho + sine_ * up - radius_[0],
            Vector3d(across * p.x(), across * p.y(), sine_)};
  }

 private:
  double radius_[2];
  double half_;
  // Sine and cosine of half the angle at the cone's tip. The cone's outward normal is (cosine,
  // sine) in (rho, z).
  double sine_;
  double cosine_;
};

/// Intersects a ray with the double cone: the roots of a quadratic form in (x, y, depth below the
/// apex).
class ConeCrossing {
 public:
  ConeCrossing(const LocalRay& ray, const ConeCore& cone) noexcept
      : cone_(cone),
        o_(ray.origin.x(), ray.origin.y(), cone.half_length - ray.origin.z()),
        d_(ray.direction.x(), ray.direction.y(), -ray.direction.z()) {}

  [[nodiscard]] RaySpan span(double speed) const noexcept {
    double a = form(d_, d_);
    double b = form(o_, d_);
    const double c = form(o_, o_);
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    // The ray is parallel to a generator of the cone, or is in its surface.
    if (std::fabs(a) <= kGrazing * speed * speed) a = 0.0;
    if (std::fabs(b) <= kGrazing * speed) b = 0.0;
    if (a == 0.0 && b == 0.0) {
      return c <= kGrazing ? RaySpan{-kInfinity, kInfinity, Vector3d::Zero()} : RaySpan{};
    }
    const double discriminant = b * b - a * c;
    if (discriminant < -kGrazing * speed * speed) return {};
    const double root = std::sqrt(std::max(0.0, discriminant));
    // Compute the root of larger magnitude first; computing the other one directly would cancel.
    const double sum = b > 0.0 ? -(b + root) : root - b;
    const double one = a != 0.0 ? sum / a : std::copysign(kInfinity, sum);
    const double other = sum != 0.0 ? c / sum : one;
    const double first = std::min(one, other);
    const double last = std::max(one, other);
    if (a < 0.0) {
      // One crossing of each nappe.
      return d_.z() > 0.0 ? from(polished(last), kInfinity) : from(-kInfinity, polished(first));
    }
    // Both crossings are on the same nappe.
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
  /// Newton's method on the height over the side; the quadratic form contains the squared height,
  /// which has only half of the digits.
  [[nodiscard]] double polished(double t) const noexcept {
    for (int step = 0; step < 2 && std::isfinite(t); ++step) {
      const Vector3d p = o_ + t * d_;
      const double rho = hypotenuse(p.x(), p.y());
      if (rho == 0.0) break;
      const double slope =
          cone_.cosine * (p.x() * d_.x() + p.y() * d_.y()) / rho - cone_.sine * d_.z();
      const double next = t - (cone_.cosine * rho - cone_.sine * p.z()) / slope;
      if (!(std::fabs(next - t) <= 1e-7 * (1.0 + std::fabs(t)))) break;
      t = next;
    }
    return t;
  }
  [[nodiscard]] RaySpan from(double in, double out) const noexcept {
    RaySpan span{in, out, Vector3d::Zero()};
    if (!std::isfinite(in)) return span;
    const Vector3d p = o_ + in * d_;
    const double rho = hypotenuse(p.x(), p.y());
    if (rho > kGrazing) {
      span.normal = Vector3d(cone_.cosine * p.x() / rho, cone_.cosine * p.y() / rho, cone_.sine);
    }
    return span;
  }

  const ConeCore& cone_;
  Vector3d o_;
  Vector3d d_;
};

/// Finds the first point within `rounding` of the core, from t on. The distance from a convex core
/// is a convex function along the ray, so Newton's method, started before the entry, never passes
/// the entry. If the ray grazes, each step only halves the remaining distance; kMaxSteps allows for
/// halving a double down to the tolerance.
template <typename Core>
void merge_rounded(const LocalRay& ray, const Core& core, double rounding, double t,
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
      // A grazing entry has only half of the digits. An entry into a flat part, which is accurate,
      // takes precedence.
      if (entry.found && !(rate < -1e-6 * ray.speed)) return;
      const bool inside = begins && step == 0 && rest < 0.0;
      entry.merge_span(ray, {inside ? -kInfinity : t, kInfinity, clear.away});
      return;
    }
    t = next;
  }
}

[[nodiscard]] RaySpan slab_span(const LocalRay& ray, double low, double high) noexcept {
  PlaneClip clip(ray);
  clip.below(Vector3d::UnitZ(), high);
  clip.below(-Vector3d::UnitZ(), -low);
  return clip.span();
}

[[nodiscard]] FirstEntry enter_axis(const LocalRay& ray, double half_length,
                                    double radius) noexcept {
  FirstEntry entry;
  entry.merge_span(ray,
                   capsule_span(ray, {0.0, 0.0, -half_length}, {0.0, 0.0, half_length}, radius));
  return entry;
}

}  // namespace

FirstEntry enter(const LocalRay& ray, const SphereShape& sphere, double scale) noexcept {
  FirstEntry entry;
  entry.merge_span(ray, ball_span(ray, Vector3d::Zero(), scale * sphere.radius));
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
  const auto merge_span = [&](double r, double h) {
    entry.merge_span(ray, common(tube_span(ray, r), slab_span(ray, -h, h)));
  };
  if (rounding == 0.0) {
    merge_span(radius, half);
    return entry;
  }
  const RaySpan hull =
      common(tube_span(ray, radius + rounding), slab_span(ray, -half - rounding, half + rounding));
  if (hull.is_empty()) return entry;
  merge_span(radius + rounding, half);
  merge_span(radius, half + rounding);
  merge_rounded(ray, CylinderCore{radius, half}, rounding, std::max(hull.in, ray.low), entry);
  return entry;
}

FirstEntry enter(const LocalRay& ray, const ConeShape& cone, double scale) noexcept {
  const double radius = scale * cone.radius;
  const double half = scale * cone.half_length;
  const double rounding = scale * cone.rounding;
  if (radius == 0.0) return enter_axis(ray, half, rounding);
  FirstEntry entry;
  const ConeCore core(radius, half);
  // For a needle-like or flat cone, the squared heights of the quadratic form lose their digits
  // beside squared lengths; use Newton's method on the distance instead.
  constexpr double kPlump = 0.0625;
  if (rounding == 0.0 && std::min(core.sine, core.cosine) < kPlump) {
    const RaySpan around = common(tube_span(ray, radius), slab_span(ray, -half, half));
    if (around.is_empty()) return entry;
    merge_rounded(ray, core, kGrazing, std::max(around.in, ray.low), entry);
    if (entry.found && !entry.inside) {
      entry.normal = core.outward(ray.at(entry.t), ray.direction);
    }
    return entry;
  }
  if (rounding == 0.0) {
    const RaySpan sides =
        half > 0.0 ? ConeCrossing(ray, core).span(ray.speed) : tube_span(ray, radius);
    entry.merge_span(ray, common(slab_span(ray, -half, half), sides));
    return entry;
  }
  const RaySpan hull =
      common(tube_span(ray, radius + rounding), slab_span(ray, -half - rounding, half + rounding));
  if (hull.is_empty()) return entry;
  // The base, extruded by the rounding: a ray can graze along it, where Newton's method is
  // inaccurate.
  entry.merge_span(ray, common(tube_span(ray, radius), slab_span(ray, -half - rounding, -half)));
  merge_rounded(ray, core, rounding, std::max(hull.in, ray.low), entry);
  return entry;
}

FirstEntry enter(const LocalRay& ray, const TaperedCapsuleShape& taper, double scale) noexcept {
  const double low = scale * taper.radius[0];
  const double high = scale * taper.radius[1];
  const double half = scale * taper.half_length;
  if (low == high) return enter_axis(ray, half, low);
  const Vector3d end(0.0, 0.0, half);
  FirstEntry entry;
  if (high - low < 2.0 * half) entry.merge_span(ray, ball_span(ray, -end, low));
  if (low - high < 2.0 * half) entry.merge_span(ray, ball_span(ray, end, high));
  if (std::fabs(high - low) >= 2.0 * half) return entry;
  const RaySpan hull = capsule_span(ray, -end, end, std::max(low, high));
  if (hull.is_empty() || hull.out < ray.low) return entry;
  merge_rounded(ray, TaperSurface(low, high, half), 0.0, std::max(hull.in, ray.low), entry);
  return entry;
}

namespace {

using Eigen::Vector3d;

[[nodiscard]] RaySpan box_span(const LocalRay& ray, const Vector3d& half) noexcept {
  PlaneClip clip(ray);
  for (int k = 0; k < 3; ++k) {
    const Vector3d axis = Vector3d::Unit(k);
    clip.below(axis, half[k]);
    clip.below(-axis, half[k]);
  }
  return clip.span();
}

/// The twelve edges of a box, as capsules.
void merge_box_edges(const LocalRay& ray, const Vector3d& half, double radius,
                     FirstEntry& entry) noexcept {
  for (int k = 0; k < 3; ++k) {
    for (unsigned signs = 0; signs < 4; ++signs) {
      Vector3d a = half;
      if ((signs & 1U) != 0) a[(k + 1) % 3] = -a[(k + 1) % 3];
      if ((signs & 2U) != 0) a[(k + 2) % 3] = -a[(k + 2) % 3];
      Vector3d b = a;
      b[k] = -b[k];
      entry.merge_span(ray, capsule_span(ray, a, b, radius));
    }
  }
}

class ScaledHull {
 public:
  ScaledHull(const HullShape& hull, double scale) noexcept : hull_(hull), scale_(scale) {}
  [[nodiscard]] Vector3d vertex(std::uint32_t i) const noexcept {
    return scale_ * Vector3d(hull_.vertex[0][i], hull_.vertex[1][i], hull_.vertex[2][i]);
  }
  [[nodiscard]] Vector3d normal(const HullFace& face) const noexcept {
    return as_eigen(face.normal);
  }
  [[nodiscard]] std::span<const HullFace> faces() const noexcept {
    return {hull_.faces, hull_.face_count};
  }
  [[nodiscard]] std::span<const HullEdge> edges() const noexcept {
    return {hull_.edges, hull_.edge_count};
  }

  [[nodiscard]] RaySpan solid(const LocalRay& ray, double grown) const noexcept {
    PlaneClip clip(ray);
    for (const HullFace& face : faces()) {
      clip.below(normal(face), scale_ * face.offset + grown);
      if (clip.span().is_empty()) break;
    }
    return clip.span();
  }
  /// The prism over a face, up to height `top`.
  [[nodiscard]] RaySpan over(const LocalRay& ray, const HullFace& face, double top) const noexcept {
    PlaneClip clip(ray);
    const Vector3d up = normal(face);
    clip.below(up, scale_ * face.offset + top);
    clip.below(-up, -scale_ * face.offset);
    for (std::uint32_t i = 0; i < face.count && !clip.span().is_empty(); ++i) {
      const Vector3d a = vertex(hull_.loop[face.first + i]);
      const Vector3d b = vertex(hull_.loop[face.first + (i + 1 < face.count ? i + 1 : 0)]);
      const Vector3d side = (b - a).cross(up).stableNormalized();
      clip.below(side, side.dot(a));
    }
    return clip.span();
  }

 private:
  const HullShape& hull_;
  double scale_;
};

}  // namespace

FirstEntry enter(const LocalRay& ray, const BoxShape& box, double scale) noexcept {
  const Vector3d half = scale * as_eigen(box.half);
  const double rounding = scale * box.rounding;
  FirstEntry entry;
  if (rounding == 0.0) {
    entry.merge_span(ray, box_span(ray, half));
    return entry;
  }
  if (box_span(ray, half + Vector3d::Constant(rounding)).is_empty()) return entry;
  for (int k = 0; k < 3; ++k)
    entry.merge_span(ray, box_span(ray, half + rounding * Vector3d::Unit(k)));
  merge_box_edges(ray, half, rounding, entry);
  return entry;
}

FirstEntry enter(const LocalRay& ray, const TriangleShape& triangle, double scale) noexcept {
  const double rounding = scale * triangle.rounding;
  std::array<Vector3d, 3> vertex;
  for (std::size_t i = 0; i < 3; ++i) vertex[i] = scale * as_eigen(triangle.vertex[i]);
  const Vector3d area = accurate_cross(vertex[1] - vertex[0], vertex[2] - vertex[0]);
  FirstEntry entry;
  if (area.stableNorm() > 0.0) {
    entry.merge_span(ray, prism_span(ray, vertex, area.stableNormalized(), -rounding, rounding));
    // Edges have no normal of their own; they add nothing if the face is hit.
    if (entry.found && rounding == 0.0) return entry;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    entry.merge_span(ray, capsule_span(ray, vertex[i], vertex[(i + 1) % 3], rounding));
  }
  return entry;
}

FirstEntry enter(const LocalRay& ray, const HullShape& hull, double scale) noexcept {
  const ScaledHull scaled(hull, scale);
  const double rounding = scale * hull.rounding;
  FirstEntry entry;
  if (hull.dimension == 0) {
    entry.merge_span(ray, ball_span(ray, scaled.vertex(0), rounding));
    return entry;
  }
  if (hull.dimension == 3) {
    if (rounding > 0.0 && scaled.solid(ray, rounding).is_empty()) return entry;
    entry.merge_span(ray, scaled.solid(ray, 0.0));
    if (rounding == 0.0) return entry;
  }
  for (const HullFace& face : scaled.faces()) {
    entry.merge_span(ray, scaled.over(ray, face, rounding));
  }
  if (entry.found && rounding == 0.0) return entry;
  for (const HullEdge& edge : scaled.edges()) {
    entry.merge_span(ray, capsule_span(ray, scaled.vertex(edge.vertex[0]),
                                       scaled.vertex(edge.vertex[1]), rounding));
  }
  return entry;
}

FirstEntry enter(const LocalRay& ray, const HalfSpaceShape& half_space, double scale) noexcept {
  const Vector3d normal = as_eigen(half_space.normal);
  const double height = normal.dot(ray.at(ray.low)) - scale * half_space.offset;
  const double rate = normal.dot(ray.direction);
  FirstEntry entry;
  if (height > 0.0 && !(rate < 0.0)) return entry;
  entry.found = true;
  entry.inside = height < 0.0 || !(rate < 0.0);
  entry.t = height > 0.0 ? ray.low - height / rate : ray.low;
  entry.normal = normal;
  return entry;
}

}  // namespace winnow
