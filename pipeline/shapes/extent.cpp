// Extents, bounds and bounding radii of convex shapes, by kind. `extent` takes any direction;
// ShapePool::bounds takes the unit rows of a rotation. Called by the mid phase, the scene and
// motion.

#include "pipeline/shapes/extent.h"
#include <winnow/core/rotation.h>
#include <winnow/core/rounding.h>
#include <winnow/pipeline/shape_pool.h>
#include "core/threads/float_environment.h"
#include "pipeline/shapes/hypotenuse.h"
#include "pipeline/shapes/support_core.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace mid {
namespace {

// The two direction types compute the quantities of a direction that extents need; UnitDirection is
// cheaper.

/// A direction of any length.
struct AnyDirection {
  const Vec& d;

  [[nodiscard]] double length() const noexcept { return d.norm(); }
  [[nodiscard]] Vec unit() const noexcept { return d.stableNormalized(); }
  /// Length of the component orthogonal to the z axis.
  [[nodiscard]] double across() const noexcept { return hypotenuse(d.x(), d.y()); }
  /// Upper bound on |d . p| over the points p of the hull's core.
  [[nodiscard]] double most(const HullShape& hull) const noexcept {
    return d.lpNorm<1>() * (Eigen::Map<const Vec>(hull.center).cwiseAbs().maxCoeff() + hull.radius);
  }
};

/// A unit direction, up to rounding; its squares neither overflow nor underflow.
struct UnitDirection {
  const Vec& d;

  [[nodiscard]] static double length() noexcept { return 1.0; }
  [[nodiscard]] const Vec& unit() const noexcept { return d; }
  [[nodiscard]] double across() const noexcept { return std::sqrt(d.x() * d.x() + d.y() * d.y()); }
  [[nodiscard]] static double most(const HullShape& hull) noexcept {
    return Eigen::Map<const Vec>(hull.center).norm() + hull.radius;
  }
};

[[nodiscard]] SupportExtent symmetric(double reach) noexcept {
  return {-reach, reach, reach};
}

[[nodiscard]] SupportExtent rounded(const SupportExtent& core, double rounding) noexcept {
  return {core.low - rounding, core.high + rounding, core.scale + rounding};
}

// Vertex columns are padded to a multiple of 16 with copies of vertex 0. Four independent minima
// and maxima hide the latency of the comparisons.
[[nodiscard]] SupportExtent of_vertices(const HullShape& hull, const Vec& d,
                                        double scale) noexcept {
  constexpr std::uint32_t kBlock = 4;
  double low[kBlock];
  double high[kBlock];
  std::fill_n(low, kBlock, kInfinity);
  std::fill_n(high, kBlock, -kInfinity);
  const double* const x = hull.vertex[0];
  const double* const y = hull.vertex[1];
  const double* const z = hull.vertex[2];
  for (std::uint32_t i = 0; i < hull.vertex_count; i += kBlock) {
    for (std::uint32_t k = 0; k < kBlock; ++k) {
      const double v = x[i + k] * d.x() + y[i + k] * d.y() + z[i + k] * d.z();
      low[k] = v < low[k] ? v : low[k];
      high[k] = v > high[k] ? v : high[k];
    }
  }
  return {std::min({low[0], low[1], low[2], low[3]}),
          std::max({high[0], high[1], high[2], high[3]}), scale};
}

[[nodiscard]] SupportExtent of_corners(const TriangleShape& triangle, const Vec& d) noexcept {
  SupportExtent extent{kInfinity, -kInfinity, 0.0};
  for (const auto& corner : triangle.vertex) {
    const Eigen::Map<const Vec> v(corner);
    const double at = v.dot(d);
    extent.low = std::min(extent.low, at);
    extent.high = std::max(extent.high, at);
    extent.scale = std::max(extent.scale, v.cwiseAbs().dot(d.cwiseAbs()));
  }
  return extent;
}

/// SupportExtent of a cone's core. `side` is the disc's extent along d, `tip` the apex's.
[[nodiscard]] SupportExtent of_cone(double side, double tip) noexcept {
  return {std::min(tip, -side - tip), std::max(tip, side - tip), side + std::abs(tip)};
}

[[nodiscard]] SupportExtent of_taper(const TaperedCapsuleShape& taper, double up,
                                     double length) noexcept {
  const double low = taper.half_length * up;
  const double first = taper.radius[0] * length;
  const double second = taper.radius[1] * length;
  return {std::min(-low - first, low - second), std::max(first - low, second + low),
          std::abs(low) + std::max(first, second)};
}

template <typename Direction>
[[nodiscard]] SupportExtent of_support(const SupportCore& core,
                                       const Direction& direction) noexcept {
  const Vec unit = direction.unit();
  const double length = direction.length();
  return {length * unit.dot(core.farthest(-unit)), length * unit.dot(core.farthest(unit)),
          length * core.radius};
}

template <typename Direction>
[[nodiscard]] SupportExtent extent_along(const ShapeTables& tables, ShapeId shape,
                                         const Direction& direction) noexcept {
  const Vec& d = direction.d;
  const std::uint32_t i = shape.index();
  switch (shape.kind()) {
    case ShapeKind::sphere:
      return symmetric(tables.spheres[i].radius * direction.length());
    case ShapeKind::capsule:
      return symmetric(tables.capsules[i].radius * direction.length() +
                       tables.capsules[i].half_length * std::abs(d.z()));
    case ShapeKind::box: {
      const BoxShape& s = tables.boxes[i];
      return symmetric(Eigen::Map<const Vec>(s.half).dot(d.cwiseAbs()) +
                       s.rounding * direction.length());
    }
    case ShapeKind::cylinder: {
      const CylinderShape& s = tables.cylinders[i];
      return symmetric(s.radius * direction.across() + s.half_length * std::abs(d.z()) +
                       s.rounding * direction.length());
    }
    case ShapeKind::cone: {
      const ConeShape& s = tables.cones[i];
      return rounded(of_cone(s.radius * direction.across(), s.half_length * d.z()),
                     s.rounding * direction.length());
    }
    case ShapeKind::hull: {
      const HullShape& s = tables.hulls[i];
      return rounded(of_vertices(s, d, direction.most(s)), s.rounding * direction.length());
    }
    case ShapeKind::triangle: {
      const TriangleShape& s = tables.triangles[i];
      return rounded(of_corners(s, d), s.rounding * direction.length());
    }
    case ShapeKind::ellipsoid: {
      const EllipsoidShape& s = tables.ellipsoids[i];
      return symmetric(Eigen::Map<const Vec>(s.radius).cwiseProduct(d).stableNorm() +
                       s.rounding * direction.length());
    }
    case ShapeKind::tapered_capsule:
      return of_taper(tables.tapered_capsules[i], d.z(), direction.length());
    case ShapeKind::support: {
      const SupportShape& s = tables.supports[i];
      return rounded(of_support(support_core(s), direction), s.rounding * direction.length());
    }
    case ShapeKind::half_space:
      break;
  }
  return {-kInfinity, kInfinity, 0.0};
}

/// Finite only if the axis equals the half-space's normal or its opposite bit for bit.
[[nodiscard]] SupportExtent of_half_space(const HalfSpaceShape& shape, const Vec& axis) noexcept {
  const Eigen::Map<const Vec> n(shape.normal);
  const bool is_above = axis == n;
  const bool is_below = axis == -n;
  return {is_below ? -shape.offset : -kInfinity, is_above ? shape.offset : kInfinity,
          is_above || is_below ? std::abs(shape.offset) : 0.0};
}

// Upper bound on the length of v that neither overflows nor underflows; at most sqrt(3) times the
// length.
[[nodiscard]] double length_bound(const Vec& v) noexcept {
  constexpr double kMinLength = 1e-150;
  const double length = v.norm();
  return length > kMinLength && length < 1.0 / kMinLength ? length : v.lpNorm<1>();
}

// position + reach, rounded up. `reach` may be infinite.
[[nodiscard]] double end_of(double position, double reach) noexcept {
  return std::isinf(reach) ? reach : add_up(position, reach);
}

[[nodiscard]] Box3 finished(const Vec& center, const Vec& half, const Vec& noise) noexcept {
  Box3 box{center - half - noise, center + half + noise};
  box.replace_nan_bounds();
  return box;
}

}  // namespace

SupportExtent extent(const ShapeTables& tables, ShapeId shape, const Vec& d) noexcept {
  return extent_along(tables, shape, AnyDirection{d});
}

double lowest(const ShapeTables& tables, ShapeId shape, const Vec& d) noexcept {
  if (shape.kind() != ShapeKind::hull) return extent(tables, shape, d).low;
  const HullShape& hull = tables.hulls[shape.index()];
  constexpr std::uint32_t kBlock = 8;
  double low[kBlock];
  std::fill_n(low, kBlock, kInfinity);
  for (std::uint32_t i = 0; i < hull.vertex_count; i += kBlock) {
    for (std::uint32_t k = 0; k < kBlock; ++k) {
      const double v = hull.vertex[0][i + k] * d.x() + hull.vertex[1][i + k] * d.y() +
                       hull.vertex[2][i + k] * d.z();
      low[k] = v < low[k] ? v : low[k];
    }
  }
  return *std::min_element(low, low + kBlock) - hull.rounding * d.norm();
}

Box3 box_under(const ShapeTables& tables, ShapeId shape, const Mat& linear, const Vec& offset,
               double grow) noexcept {
  Box3 box;
  for (int i = 0; i < 3; ++i) {
    const Vec row = linear.row(i);
    const SupportExtent reach = extent(tables, shape, row);
    const double out = grow * row.norm() + kSlack * (reach.scale + std::abs(offset[i]));
    box.min[i] = offset[i] + reach.low - out;
    box.max[i] = offset[i] + reach.high + out;
  }
  box.replace_nan_bounds();
  return box;
}

Box3 box_under(const Box3& box, const Mat& linear, const Vec& offset, double grow) noexcept {
  const Vec center = 0.5 * box.min + 0.5 * box.max;
  const Vec half = 0.5 * box.max - 0.5 * box.min;
  const Mat size = linear.cwiseAbs();
  const Vec at = linear * center + offset;
  const Vec noise = kSlack * (size * (center.cwiseAbs() + half) + offset.cwiseAbs());
  return finished(at, size * half + grow * linear.rowwise().norm(), noise);
}

double radius_of(const ShapeTables& tables, ShapeId shape) noexcept {
  const std::uint32_t i = shape.index();
  double radius = kInfinity;
  switch (shape.kind()) {
    case ShapeKind::sphere:
      radius = tables.spheres[i].radius;
      break;
    case ShapeKind::capsule:
      radius = tables.capsules[i].radius + tables.capsules[i].half_length;
      break;
    case ShapeKind::box:
      radius = length_bound(Eigen::Map<const Vec>(tables.boxes[i].half)) + tables.boxes[i].rounding;
      break;
    case ShapeKind::cylinder: {
      const CylinderShape& s = tables.cylinders[i];
      radius = hypotenuse(s.radius, s.half_length) + s.rounding;
      break;
    }
    case ShapeKind::cone: {
      const ConeShape& s = tables.cones[i];
      radius = hypotenuse(s.radius, s.half_length) + s.rounding;
      break;
    }
    case ShapeKind::hull: {
      const HullShape& s = tables.hulls[i];
      radius = length_bound(Eigen::Map<const Vec>(s.center)) + s.radius + s.rounding;
      break;
    }
    case ShapeKind::triangle: {
      radius = 0.0;
      for (const auto& corner : tables.triangles[i].vertex) {
        radius = std::max(radius, Eigen::Map<const Vec>(corner).stableNorm());
      }
      radius += tables.triangles[i].rounding;
      break;
    }
    case ShapeKind::ellipsoid:
    case ShapeKind::tapered_capsule:
    case ShapeKind::support: {
      const SupportCore core = support_core(tables, shape);
      radius = core.radius + core.rounding;
      break;
    }
    case ShapeKind::half_space:
      break;
  }
  return radius;
}

double rounding_of(const ShapeTables& tables, ShapeId shape) noexcept {
  const std::uint32_t i = shape.index();
  switch (shape.kind()) {
    case ShapeKind::sphere:
      return tables.spheres[i].radius;
    case ShapeKind::capsule:
      return tables.capsules[i].radius;
    case ShapeKind::box:
      return tables.boxes[i].rounding;
    case ShapeKind::cylinder:
      return tables.cylinders[i].rounding;
    case ShapeKind::cone:
      return tables.cones[i].rounding;
    case ShapeKind::hull:
      return tables.hulls[i].rounding;
    case ShapeKind::triangle:
      return tables.triangles[i].rounding;
    case ShapeKind::ellipsoid:
    case ShapeKind::tapered_capsule:
    case ShapeKind::support:
      return support_core(tables, shape).rounding;
    case ShapeKind::half_space:
      break;
  }
  return 0.0;
}

}  // namespace mid

Aabb ShapePool::bounds(ShapeId id, const Pose& pose) const noexcept {
  const DefaultFloatEnvironment environment;
  // A sphere needs no rotation.
  const mid::Mat turn =
      id.kind() == ShapeKind::sphere
          ? mid::Mat(mid::Mat::Identity())
          : mid::Mat(rotation_of_unit(normalized(scale_to_unit_max(pose.orientation))));
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    const mid::Vec row = turn.row(axis);
    const mid::SupportExtent reach = id.kind() == ShapeKind::half_space
                                         ? mid::of_half_space(tables_.half_spaces[id.index()], row)
                                         : mid::extent_along(tables_, id, mid::UnitDirection{row});
    // Covers the rounding of the rotation and of the sums below.
    const double slack = mid::kSlack * reach.scale;
    box.max[axis] = round_up(mid::end_of(pose.position[axis], reach.high + slack));
    box.min[axis] = -round_up(mid::end_of(-pose.position[axis], -reach.low + slack));
  }
  return box;
}

}  // namespace winnow
