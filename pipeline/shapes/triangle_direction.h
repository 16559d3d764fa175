#pragma once

#include "pipeline/shapes/frame.h"

namespace winnow::mid {

/// Returns the vector from the closest point of a triangle to `point`, up to rounding. `point` is
/// relative to the triangle's first corner; `ab` and `ac` are the edges from there. If the closest
/// point is inside the face, the result has the direction of that vector but not its length
/// (Ericson, Real-Time Collision Detection, 5.1.5). Callers use the result as a search direction
/// only, so that its error is harmless.
[[nodiscard]] inline Vec direction_to(const Vec& point, const Vec& ab, const Vec& ac) noexcept {
  const double d1 = ab.dot(point);
  const double d2 = ac.dot(point);
  if (d1 <= 0.0 && d2 <= 0.0) return point;
  const double aa = ab.squaredNorm();
  const double cc = ac.squaredNorm();
  const double bc = ab.dot(ac);
  const double d3 = d1 - aa;
  const double d4 = d2 - bc;
  if (d3 >= 0.0 && d4 <= d3) return point - ab;
  const double d5 = d1 - bc;
  const double d6 = d2 - cc;
  if (d6 >= 0.0 && d5 <= d6) return point - ac;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return point - ab * (d1 / (d1 - d3));
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return point - ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return point - ab - (ac - ab) * along;
  }
  const Vec normal = ab.cross(ac);
  return normal.dot(point) < 0.0 ? Vec(-normal) : normal;
}

}  // namespace winnow::mid
