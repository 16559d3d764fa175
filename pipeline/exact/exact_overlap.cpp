#include "pipeline/exact/exact_overlap.h"
#include "pipeline/exact/half_space_exact.h"
#include "pipeline/exact/origin_walk.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace {

/// The axis by which the search begins. Any will do, so digits that are small beside the largest
/// are dropped; +x for none.
[[nodiscard]] ExactVector first_direction(const double axis[3]) noexcept {
  const double largest = std::max({std::fabs(axis[0]), std::fabs(axis[1]), std::fabs(axis[2])});
  const double sum = axis[0] + axis[1] + axis[2];
  if (!(largest > 0.0) || !std::isfinite(largest) || std::isnan(sum)) {
    return {{1.0, 0.0, 0.0}};
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  ExactVector direction;
  for (int k = 0; k < 3; ++k) {
    constexpr int kDigits = 40;
    direction.x[k] = std::nearbyint(std::ldexp(axis[k], kDigits - exponent));
  }
  return direction;
}

[[nodiscard]] ExactVerdict half_space_pair(const ShapeTables& tables, ShapeId half_space,
                                           const Pose& half_space_pose, ShapeId other,
                                           const Pose& other_pose) noexcept {
  const HalfSpaceShape& shape = tables.half_spaces[half_space.index()];
  CoreVertices core;
  if (core_vertices(tables, other, core)) {
    return half_space_verdict(shape, half_space_pose, core, other_pose);
  }
  return half_spaces_verdict(shape, half_space_pose, tables.half_spaces[other.index()], other_pose);
}

/// Cylinders and cones, between a bound from outside along the direction given and polygons
/// inscribed in their discs: decided where one of them suffices, or both meet.
[[nodiscard]] ExactVerdict bounded_verdict(const CoreDifference& difference, const Dyadic& rounding,
                                           const ExactVector& direction) noexcept {
  const Dyadic length = root_above(dot(direction, direction));
  const Dyadic height = difference.height_bound(direction) + rounding * difference.scale() * length;
  if (height.sign() < 0) return ExactVerdict::separated;
  const ExactVerdict inscribed = locate_origin(difference, rounding, direction);
  if (inscribed == ExactVerdict::overlapping) return inscribed;
  const bool both = inscribed == ExactVerdict::touching && height.sign() == 0;
  return both ? ExactVerdict::touching : ExactVerdict::undecided;
}

}  // namespace

ExactVerdict exact_overlap(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
                           const Pose& pose_b, const double axis[3]) noexcept {
  if (a.kind() == ShapeKind::half_space) return half_space_pair(tables, a, pose_a, b, pose_b);
  if (b.kind() == ShapeKind::half_space) return half_space_pair(tables, b, pose_b, a, pose_a);
  CoreVertices core_a;
  CoreVertices core_b;
  if (!core_vertices(tables, a, core_a) || !core_vertices(tables, b, core_b)) {
    return ExactVerdict::undecided;
  }
  const CoreDifference difference(core_a, pose_a, core_b, pose_b);
  if (!difference.in_range()) return ExactVerdict::undecided;
  const ExactVector direction = first_direction(axis);
  const Dyadic rounding = Dyadic(core_a.rounding) + core_b.rounding;
  if (core_a.has_discs || core_b.has_discs) {
    return bounded_verdict(difference, rounding, direction);
  }
  return locate_origin(difference, rounding, direction);
}

}  // namespace winnow
