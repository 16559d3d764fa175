#pragma once

#include <winnow/core/vectors.h>

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
  [[nodiscard]] bool is_active(const Vec3d& u, const Vec3d& v, const Vec3d& p, const Vec3d& q,
                               bool consistent) const noexcept {
    const Vec3d edge = Vec3d(v) - Vec3d(u);
    const Vec3d to_p = Vec3d(p) - Vec3d(u);
    const Vec3d to_q = Vec3d(q) - Vec3d(u);
    Vec3d n = edge.cross(to_p);
    Vec3d m = to_q.cross(edge);
    const double nn = n.squared_norm();
    const double mm = m.squared_norm();
    const double ee = edge.squared_norm();
    const double pp = to_p.squared_norm();
    const double qq = to_q.squared_norm();
    // The cross product of parallel edges is only rounding error.
    if (!(nn > kFlat * ee * pp) || !(mm > kFlat * ee * qq)) return true;
    if (consistent && is_above(n, nn, to_q, qq) && is_above(m, mm, to_p, pp)) return false;
    n *= 1.0 / std::sqrt(nn);
    m *= 1.0 / std::sqrt(mm);
    // The sine of bend - angle; the difference is between -pi and pi.
    const double bend_sine = n.cross(m).norm();
    const double bend_cosine = n.dot(m);
    const bool folded = bend_cosine < 0.0 && bend_sine <= kRounding;
    if (folded) return !is_straight_;
    return bend_sine * cosine_ - bend_cosine * sine_ > kRounding;
  }

 private:
  static constexpr double kFlat = 1e-24;
  static constexpr double kRounding = 1e-12;

  /// Returns whether `to` is above the plane by more than rounding; `nn` and `tt` are the squared
  /// lengths.
  static bool is_above(const Vec3d& normal, double nn, const Vec3d& to, double tt) noexcept {
    const double height = normal.dot(to);
    return height > 0.0 && height * height > kFlat * nn * tt;
  }

  double cosine_;
  double sine_;
  bool is_straight_;
};

}  // namespace winnow
