#pragma once

// Ellipsoids in their own frame: the support point along a direction, and the nearest point of the
// surface to a point. Used by round_ellipsoid.kernel.cpp and motion/closed_forms.wide.h.

#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::round {

template <typename T>
[[gnu::always_inline]] inline Vec3<T> times(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

/// The support point of an ellipsoid and its height along the direction.
template <typename T>
struct EllipsoidSupport {
  Lanes<T> height;
  Vec3<T> point;
};

template <typename T>
[[gnu::always_inline]] inline EllipsoidSupport<T> reach_of(const Vec3<T>& radius,
                                                           const Vec3<T>& direction) {
  const Vec3<T> stretched = times(radius, direction);
  const Lanes<T> height = sqrt(dot(stretched, stretched));
  const Lanes<T> least(sizeof(T) == sizeof(double) ? T(1e-150) : T(1e-18F));
  return {height, times(radius, stretched) * (Lanes<T>(T(1)) / max(height, least))};
}

/// The nearest point of an ellipsoid's surface to a point q, in the ellipsoid's frame. No
/// coordinate of q may be negative: the caller mirrors q. The normal there is parallel to q_i / (s
/// + e_i), where e_i are the squares of the radii minus the square of the smallest, and s is the
/// largest number for which r_i q_i / (s + e_i) is a unit vector (Eberly, "Distance from a point to
/// an ellipse, an ellipsoid, or a hyperellipsoid", 2013). The inverse of that vector's length is
/// nearly linear in s; Newton's method for it approaches the root from below (as in Moré and
/// Sorensen, "Computing a trust region step", 1983).
template <typename T>
struct SurfaceView {
  /// Unit normal of the surface.
  Vec3<T> outward;
  /// Bounds of the signed distance of q from the ellipsoid.
  Lanes<T> low;
  Lanes<T> high;
};

template <typename T>
[[gnu::always_inline]] inline SurfaceView<T> view_surface(const Vec3<T>& radius, const Vec3<T>& q) {
  constexpr int steps = sizeof(T) == sizeof(double) ? 8 : 6;
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const Lanes<T> thin = min(min(radius.x, radius.y), radius.z);
  const auto square_beyond = [&](const Lanes<T>& r) { return (r - thin) * (r + thin); };
  const Vec3<T> excess{square_beyond(radius.x), square_beyond(radius.y), square_beyond(radius.z)};
  const Vec3<T> weight = times(radius, q);
  const auto of_least = [&](const Lanes<T>& w, const Lanes<T>& e) {
    return select(e > zero, zero, w * w);
  };
  // The start of the iteration is a lower bound of the root, or `tiny`, if that is larger: s must
  // not be 0, which has no inverse. `tiny` is negligible compared with the largest squared radius.
  const Lanes<T> most = max(max(radius.x, radius.y), radius.z);
  const Lanes<T> tiny = most * most * Lanes<T>(sizeof(T) == sizeof(double) ? T(1e-30) : T(1e-12F));
  Lanes<T> s = max(sqrt(of_least(weight.x, excess.x) + of_least(weight.y, excess.y) +
                        of_least(weight.z, excess.z)),
                   tiny);
  const auto inverse = [&] {
    return Vec3<T>{one / (s + excess.x), one / (s + excess.y), one / (s + excess.z)};
  };
  Vec3<T> over = inverse();
  for (int i = 0; i < steps; ++i) {
    const Vec3<T> share = times(weight, over);
    const Lanes<T> square = dot(share, share);
    const Lanes<T> bend = dot(times(share, share), over);
    s = s + max((sqrt(square) - one) * square / bend, zero);
    over = inverse();
  }
  const Vec3<T> way = times(q, over);
  const Vec3<T> outward = way * (one / sqrt(dot(way, way)));
  const Vec3<T> share = times(weight, over);
  const Lanes<T> within = one / max(sqrt(dot(share, share)), one);
  const Vec3<T> gap = q - times(radius, share) * within;
  // `least` is Lagrange's dual function: for any t above -thin^2 it is a lower bound of the squared
  // distance to the surface. If t <= 0, q is inside. If this bound is then not positive, q is on
  // the surface up to rounding or has no s, and `high` is NaN.
  const Lanes<T> t = s - thin * thin;
  const Lanes<T> least = t * (dot(times(q, q), over) - one);
  const Lanes<T> unknown(T(__builtin_nan("")));
  const Lanes<T> inside = select(least > zero, -sqrt(max(least, zero)), unknown);
  const Lanes<T> low = dot(outward, q) - reach_of(radius, outward).height;
  return {outward, low, select(t > zero, sqrt(dot(gap, gap)), inside)};
}

}  // namespace winnow::WINNOW_ISA_NAME::round
