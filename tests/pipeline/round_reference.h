#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

namespace winnow::test {

using LongVector = Eigen::Matrix<long double, 3, 1>;

/// A sphere, capsule, box, triangle or half-space in long double, relative to some position.
struct ReferenceShape {
  ShapeKind kind{};
  std::vector<LongVector> vertices;
  std::vector<std::pair<LongVector, LongVector>> edges;
  std::vector<std::array<LongVector, 3>> faces;
  /// Outward unit normals of the faces.
  std::vector<LongVector> normals;
  /// Half-spaces only: normals[0] . x <= offset.
  long double offset = 0;
  /// Half-spaces only: the sum of the magnitudes from which the offset is computed.
  long double reach = 0;
  long double rounding = 0;
};

[[nodiscard]] ReferenceShape make_reference(const ShapeTables& tables, ShapeId id, const Pose& pose,
                                            const double origin[3]);

/// Returns the signed distance by testing all pairs of features and all separating axes. Error
/// 1e-17 of the sizes, except for overlapping cores with edges within 1e-3 of parallel.
[[nodiscard]] long double reference_distance(const ReferenceShape& a, const ReferenceShape& b);

/// Returns how far b must move along n to be beyond a. Negative if it is beyond already.
[[nodiscard]] long double reference_overlap_along(const ReferenceShape& a, const ReferenceShape& b,
                                                  const LongVector& n);

/// Returns the distance of a point from the shape, 0 inside.
[[nodiscard]] long double reference_distance(const ReferenceShape& shape, const LongVector& point);

/// Returns the sum of the shapes' extents and offset.
[[nodiscard]] long double reference_scale(const ReferenceShape& a, const ReferenceShape& b);

}  // namespace winnow::test
