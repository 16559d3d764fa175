#include "pipeline/shapes/extent.h"

#include <algorithm>
#include <cmath>

namespace winnow::mid {
namespace {

[[nodiscard]] Extent symmetric(double reach) noexcept {
  return {-reach, reach, reach};
}

// Vertex columns are padded to 16 by copies of vertex 0; four independent minima and maxima keep
// the loop from waiting for each comparison.
[[nodiscard]] Extent of_hull(const HullShape& hull, const Vec& d) noexcept {
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
  const double rounding = hull.rounding * d.norm();
  const double size = Eigen::Map<const Vec>(hull.center).cwiseAbs().maxCoeff() + hull.radius;
  return {std::min({low[0], low[1], low[2], low[3]}) - rounding,
          std::max({high[0], high[1], high[2], high[3]}) + rounding,
          d.lpNorm<1>() * size + rounding};
}

[[nodiscard]] Extent of_triangle(const TriangleShape& triangle, const Vec& d) noexcept {
  Extent extent{kInfinity, -kInfinity, 0.0};
  for (const auto& corner : triangle.vertex) {
    const Eigen::Map<const Vec> v(corner);
    const double at = v.dot(d);
    extent.low = std::min(extent.low, at);
    extent.high = std::max(extent.high, at);
    extent.scale = std::max(extent.scale, v.cwiseAbs().dot(d.cwiseAbs()));
  }
  const double rounding = triangle.rounding * d.norm();
  return {extent.low - rounding, extent.high + rounding, extent.scale + rounding};
}

[[nodiscard]] Extent of_cone(const ConeShape& cone, const Vec& d) noexcept {
  const double side = cone.radius * std::hypot(d.x(), d.y());
  const double tip = cone.half_length * d.z();
  const double rounding = cone.rounding * d.norm();
  return {std::min(tip, -side - tip) - rounding, std::max(tip, side - tip) + rounding,
          side + std::abs(tip) + rounding};
}

// An upper bound that neither overflows nor vanishes, within 1.8 of the length.
[[nodiscard]] double length(const Vec& v) noexcept {
  const double exact = v.norm();
  return exact > 1e-150 && exact < 1e150 ? exact : v.lpNorm<1>();
}

[[nodiscard]] Box finished(const Vec& center, const Vec& half, const Vec& noise) noexcept {
  Box box{center - half - noise, center + half + noise};
  box.settle();
  return box;
}

}  // namespace

Extent extent(const ShapeTables& tables, ShapeId shape, const Vec& d) noexcept {
  const std::uint32_t i = shape.index();
  switch (shape.kind()) {
    case ShapeKind::sphere:
      return symmetric(tables.spheres[i].radius * d.norm());
    case ShapeKind::capsule:
      return symmetric(tables.capsules[i].radius * d.norm() +
                       tables.capsules[i].half_length * std::abs(d.z()));
    case ShapeKind::box: {
      const BoxShape& s = tables.boxes[i];
      return symmetric(Eigen::Map<const Vec>(s.half).dot(d.cwiseAbs()) + s.rounding * d.norm());
    }
    case ShapeKind::cylinder: {
      const CylinderShape& s = tables.cylinders[i];
      return symmetric(s.radius * std::hypot(d.x(), d.y()) + s.half_length * std::abs(d.z()) +
                       s.rounding * d.norm());
    }
    case ShapeKind::cone:
      return of_cone(tables.cones[i], d);
    case ShapeKind::hull:
      return of_hull(tables.hulls[i], d);
    case ShapeKind::triangle:
      return of_triangle(tables.triangles[i], d);
    case ShapeKind::half_space:
      break;
  }
  return {-kInfinity, kInfinity, 0.0};
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

Box box_under(const ShapeTables& tables, ShapeId shape, const Mat& linear, const Vec& offset,
              double grow) noexcept {
  Box box;
  for (int i = 0; i < 3; ++i) {
    const Vec row = linear.row(i);
    const Extent reach = extent(tables, shape, row);
    const double out = grow * row.norm() + kSlack * (reach.scale + std::abs(offset[i]));
    box.min[i] = offset[i] + reach.low - out;
    box.max[i] = offset[i] + reach.high + out;
  }
  box.settle();
  return box;
}

Box box_under(const Box& box, const Mat& linear, const Vec& offset, double grow) noexcept {
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
      radius = length(Eigen::Map<const Vec>(tables.boxes[i].half)) + tables.boxes[i].rounding;
      break;
    case ShapeKind::cylinder: {
      const CylinderShape& s = tables.cylinders[i];
      radius = std::hypot(s.radius, s.half_length) + s.rounding;
      break;
    }
    case ShapeKind::cone: {
      const ConeShape& s = tables.cones[i];
      radius = std::hypot(s.radius, s.half_length) + s.rounding;
      break;
    }
    case ShapeKind::hull: {
      const HullShape& s = tables.hulls[i];
      radius = length(Eigen::Map<const Vec>(s.center)) + s.radius + s.rounding;
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
    case ShapeKind::half_space:
      break;
  }
  return radius * (1.0 + kSlack);
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
    case ShapeKind::half_space:
      break;
  }
  return 0.0;
}

}  // namespace winnow::mid
