#pragma once

#include <cmath>

namespace winnow {

/// Tests whether two triangles that share an edge form a convex (outward) bend of more than an
/// angle. In double; a bend that rounding of the corners' differences could cause counts as none.
class EdgeBend {
 public:
  explicit EdgeBend(double angle) noexcept
      : cosine_(std::cos(angle)), sine_(std::sin(angle)), is_straight_(cosine_ <= -1.0) {}

  /// Returns whether the edge is active. The edge runs from u to v in the first triangle; p and q
  /// are the third corners of the first and second triangle. If `consistent`, outward is the side
  /// from which u, v, p are counter-clockwise; else bends to both sides count. Also true if a
  /// triangle has no area.
  [[nodiscard]] bool is_active(const double (&u)[3], const double (&v)[3], const double (&p)[3],
                               const double (&q)[3], bool consistent) const noexcept {
    const Vector edge = between(u, v);
    const Vector to_p = between(u, p);
    const Vector to_q = between(u, q);
    Vector n = cross(edge, to_p);
    Vector m = cross(to_q, edge);
    const double nn = dot(n, n);
    const double mm = dot(m, m);
    const double ee = dot(edge, edge);
    const double pp = dot(to_p, to_p);
    const double qq = dot(to_q, to_q);
    // The cross product of parallel edges is only rounding error.
    if (!(nn > kFlat * ee * pp) || !(mm > kFlat * ee * qq)) return true;
    if (consistent && is_above(n, nn, to_q, qq) && is_above(m, mm, to_p, pp)) return false;
    n = scaled(n, 1.0 / std::sqrt(nn));
    m = scaled(m, 1.0 / std::sqrt(mm));
    // The sine of bend - angle; the difference is between -pi and pi.
    const Vector c = cross(n, m);
    const double bend_sine = std::sqrt(dot(c, c));
    const double bend_cosine = dot(n, m);
    const bool folded = bend_cosine < 0.0 && bend_sine <= kRounding;
    if (folded) return !is_straight_;
    return bend_sine * cosine_ - bend_cosine * sine_ > kRounding;
  }

 private:
  struct Vector {
    double x, y, z;
  };
  static constexpr double kFlat = 1e-24;
  static constexpr double kRounding = 1e-12;

  /// Returns whether `to` is above the plane by more than rounding; `nn` and `tt` are the squared
  /// lengths.
  static bool is_above(const Vector& normal, double nn, const Vector& to, double tt) noexcept {
    const double height = dot(normal, to);
    return height > 0.0 && height * height > kFlat * nn * tt;
  }

  static Vector between(const double (&a)[3], const double (&b)[3]) noexcept {
    return {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  }
  static Vector cross(const Vector& a, const Vector& b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  static Vector scaled(const Vector& a, double s) noexcept { return {a.x * s, a.y * s, a.z * s}; }
  static double dot(const Vector& a, const Vector& b) noexcept {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }

  double cosine_;
  double sine_;
  bool is_straight_;
};

}  // namespace winnow
