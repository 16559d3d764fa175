// How far a core reaches from an axis and from its center, by kind. Called by moving_pair.cpp.

#include "pipeline/motion/core_reach.h"

#include "pipeline/kinds/hypotenuse.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace winnow::impact {
namespace {

using solver::Core;
using solver::Vec;

/// Length of the part orthogonal to z; |w| is at most 1.
double across_z(const Vec& w) noexcept {
  return std::sqrt(w.x() * w.x() + w.y() * w.y());
}

/// The largest distance of a rim of `radius` at height z from an axis w.
double rim_reach(double radius, double z, const Vec& w) noexcept {
  const double nearest = std::max(0.0, std::abs(z * w.z()) - radius * across_z(w));
  return std::sqrt(std::max(0.0, radius * radius + z * z - nearest * nearest));
}

double reach_of_corners(const Core& core, const Vec& w) noexcept {
  double square = 0.0;
  for (std::uint32_t i = 0; i < vertex_count(core); ++i) {
    square = std::max(square, (vertex(core, i) - core.center).cross(w).squaredNorm());
  }
  return std::sqrt(square);
}

double reach_of_hull(const Core& core, const Vec& w) noexcept {
  const HullShape& hull = *core.hull;
  double square = 0.0;
  for (std::uint32_t i = 0; i < hull.vertex_count; ++i) {
    const auto own = [&](std::size_t axis) { return core.scale(hull.vertex[axis][i]); };
    const double x = own(1) * w.z() - own(2) * w.y();
    const double y = own(2) * w.x() - own(0) * w.z();
    const double z = own(0) * w.y() - own(1) * w.x();
    square = std::max(square, x * x + y * y + z * z);
  }
  return std::sqrt(square);
}

}  // namespace

double reach_about(const Core& core, const Vec& w) noexcept {
  switch (core.kind) {
    case ShapeKind::sphere:
    case ShapeKind::half_space:
      return 0.0;
    case ShapeKind::capsule:
      return core.half.z() * across_z(w);
    case ShapeKind::cylinder:
      return rim_reach(core.half.x(), core.half.z(), w);
    case ShapeKind::cone:
      return std::max(rim_reach(core.half.x(), -core.half.z(), w), core.half.z() * across_z(w));
    case ShapeKind::hull:
      return reach_of_hull(core, w);
    default:
      return core.farthest.function != nullptr ? core.size - core.rounding
                                               : reach_of_corners(core, w);
  }
}

bool is_invariant(const Core& core, const Vec& w) noexcept {
  switch (core.kind) {
    case ShapeKind::sphere:
      return true;
    case ShapeKind::capsule:
    case ShapeKind::cylinder:
    case ShapeKind::cone:
      return across_z(w) <= kSameAxis;
    case ShapeKind::half_space:
      return core.normal.cross(w).norm() <= kSameAxis;
    default:
      return false;
  }
}

double extent(const Core& core) noexcept {
  const auto& corner = core.corner;
  switch (core.kind) {
    case ShapeKind::half_space:
      return 0.0;
    case ShapeKind::cylinder:
    case ShapeKind::cone:
      return core.rounding + hypotenuse(core.half.x(), core.half.z());
    case ShapeKind::hull:
      return core.rounding + core.scale(core.hull->radius);
    case ShapeKind::triangle:
      return core.rounding +
             std::max({(corner[1] - corner[0]).norm(), (corner[2] - corner[1]).norm(),
                       (corner[0] - corner[2]).norm()}) /
                 2.0;
    default:
      return core.size;
  }
}

}  // namespace winnow::impact
