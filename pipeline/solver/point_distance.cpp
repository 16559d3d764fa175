#include "pipeline/solver/point_distance.h"

#include "pipeline/kinds/hypotenuse.h"

#include <cmath>

namespace winnow::solver {
namespace {

/// The radii of an ellipsoid and their differences from the smallest one.
struct EllipsoidRadii {
  explicit EllipsoidRadii(const Vec& lengths) noexcept : radius(lengths) {
    radius.minCoeff(&least);
    thin = radius[least];
    excess = (radius.array() - thin) * (radius.array() + thin);
  }
  Vec radius;
  int least = 0;
  double thin = 0.0;
  /// The squared radii minus the square of the smallest.
  Vec excess;
};

/// Returns the outward normal for a point q for which the equation has no root, because its weights
/// along the axes of the smallest radius are 0. The nearest points of the surface are then on both
/// sides of q along these axes; takes one of them. `left`: 1 minus the sum of squares.
Vec outward_along_thin(const EllipsoidRadii& shape, const Vec& q, double left) noexcept {
  Vec normal = Vec::Zero();
  if (shape.thin == 0.0) {
    for (int i = 0; i < 3; ++i) normal[i] = shape.excess[i] > 0.0 ? 0.0 : q[i];
    return normal == Vec::Zero() ? Vec(Vec::Unit(shape.least)) : unit(normal);
  }
  for (int i = 0; i < 3; ++i) {
    if (!(shape.excess[i] > 0.0)) continue;
    const double share = shape.radius[i] * q[i] / shape.excess[i];
    normal[i] = share * (shape.thin / shape.radius[i]);
  }
  normal[shape.least] = std::sqrt(left);
  return unit(normal);
}

/// Returns the outward normal at the point of an ellipsoid's surface that is nearest to q, a point
/// in its frame. Up to a factor its components are q_i / (s + excess_i), for the largest s at which
/// the squares of weight_i / (s + excess_i) add up to 1.
Vec outward_of_ellipsoid(const Vec& radius, const Vec& q) noexcept {
  const EllipsoidRadii shape(radius);
  const Vec weight = radius.cwiseProduct(q.cwiseAbs());
  double s = 0.0;
  for (int i = 0; i < 3; ++i) s = shape.excess[i] > 0.0 ? s : hypotenuse(s, weight[i]);
  // The sum is convex and falls with s: Newton's method from the left never passes the root.
  constexpr int kMaxSteps = 200;
  for (int step = 0; step < kMaxSteps; ++step) {
    double sum = -1.0;
    double slope = 0.0;
    for (int i = 0; i < 3; ++i) {
      if (weight[i] == 0.0) continue;
      const double share = weight[i] / (s + shape.excess[i]);
      sum += share * share;
      slope += 2.0 * share * share / (s + shape.excess[i]);
    }
    if (s == 0.0 && sum <= 0.0) return outward_along_thin(shape, q, -sum);
    const double next = s + sum / slope;
    if (!(next > s)) break;
    s = next;
  }
  // Multiply by s: the factor 1 / s of the smallest radius may overflow.
  Vec normal = Vec::Zero();
  for (int i = 0; i < 3; ++i) {
    normal[i] = shape.excess[i] > 0.0 ? q[i] * (s / (s + shape.excess[i])) : q[i];
  }
  return unit(normal == Vec::Zero() ? q : normal);
}

/// As outward_of_ellipsoid, for the convex hull of balls of radii `low` at z = -half and `high` at
/// z = half.
Vec outward_of_taper(double low, double high, double half, const Vec& q) noexcept {
  const double rho = hypotenuse(q.x(), q.y());
  const Vec out = rho > 0.0 ? Vec(q.x() / rho, q.y() / rho, 0.0) : Vec(Vec::UnitX());
  const double rise = low - high;
  const bool swallows = std::abs(rise) >= 2.0 * half;
  const double sine = swallows ? 0.0 : rise / (2.0 * half);
  const double cosine = std::sqrt((1.0 - sine) * (1.0 + sine));
  const double along = cosine * (q.z() + half) - sine * rho;
  bool is_low = along <= 0.0;
  if (swallows) is_low = rise >= 0.0;
  if (!swallows && !is_low && along < 2.0 * half * cosine) {
    return out * cosine + Vec(0.0, 0.0, sine);
  }
  const double side = is_low ? -1.0 : 1.0;
  const Vec normal = unit(q - Vec(0.0, 0.0, side * half));
  return normal == Vec::Zero() ? Vec(0.0, 0.0, side) : normal;
}

}  // namespace

Vec axis_from_point(const Problem& problem) noexcept {
  const Core& b = problem.b;
  if (problem.a.kind != ShapeKind::sphere || b.farthest.function == nullptr) return Vec::Zero();
  const Vec q = b.rotation.transpose() * (problem.a.center - b.center);
  Vec outward = Vec::Zero();
  if (b.kind == ShapeKind::ellipsoid) {
    const auto& shape = *static_cast<const EllipsoidShape*>(b.farthest.shape);
    outward = outward_of_ellipsoid(
        {b.scale(shape.radius[0]), b.scale(shape.radius[1]), b.scale(shape.radius[2])}, q);
  } else if (b.kind == ShapeKind::tapered_capsule) {
    const auto& shape = *static_cast<const TaperedCapsuleShape*>(b.farthest.shape);
    const double less = b.farthest.rounding;
    outward = outward_of_taper(b.scale(shape.radius[0] - less), b.scale(shape.radius[1] - less),
                               b.scale(shape.half_length), q);
  }
  return b.rotation * -outward;
}

}  // namespace winnow::solver
