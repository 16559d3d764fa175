// Extents, bounds and bounding radii of convex shapes by id. `extent` takes any direction;
// ShapePool::bounds takes the unit rows of a rotation. Called by the mid phase, the scene and
// motion.

#include "pipeline/shapes/extent.h"
#include <winnow/core/pose.h>
#include <winnow/core/volumes.h>
#include <winnow/pipeline/shape_pool.h>
#include "core/numbers/rotation.h"
#include "core/numbers/rounding.h"
#include "core/threads/float_environment.h"
#include "pipeline/kinds/kinds.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace mid {
namespace {

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
  return with_shape(tables, shape,
                    [&](const auto& one) { return extent_of(one, AnyDirection{d}); });
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
  return with_shape(tables, shape, [](const auto& one) { return winnow::radius_of(one); });
}

double rounding_of(const ShapeTables& tables, ShapeId shape) noexcept {
  return with_shape(tables, shape, [](const auto& one) { return winnow::rounding_of(one); });
}

}  // namespace mid

Aabb ShapePool::bounds(ShapeId id, const Pose& pose) const noexcept {
  const DefaultFloatEnvironment environment;
  // A sphere needs no rotation.
  const mid::Mat turn =
      id.kind() == ShapeKind::sphere
          ? mid::Mat(mid::Mat::Identity())
          : mid::Mat(rotation_of_unit(normalized(scale_to_unit_max(pose.orientation))));
  return with_shape(tables_, id, [&](const auto& shape) {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
      const mid::Vec row = turn.row(axis);
      const SupportExtent reach = extent_of(shape, UnitDirection{row});
      // Covers the rounding of the rotation and of the sums below.
      const double slack = mid::kSlack * reach.scale;
      box.max[axis] = round_up(mid::end_of(pose.position[axis], reach.high + slack));
      box.min[axis] = -round_up(mid::end_of(-pose.position[axis], -reach.low + slack));
    }
    return box;
  });
}

}  // namespace winnow
