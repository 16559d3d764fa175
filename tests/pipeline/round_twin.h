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
struct TwinShape {
  ShapeKind kind{};
  std::vector<LongVector> vertices;
  std::vector<std::pair<LongVector, LongVector>> edges;
  std::vector<std::array<LongVector, 3>> faces;
  /// Unit vectors along which the shape ends in a face.
  std::vector<LongVector> normals;
  /// Of a half-space: normals[0] . x <= offset.
  long double offset = 0;
  /// Of a half-space: the magnitudes of what the offset is the sum of.
  long double reach = 0;
  long double rounding = 0;
};

[[nodiscard]] TwinShape make_twin(const ShapeTables& tables, ShapeId id, const Pose& pose,
                                  const double origin[3]);

/// The signed distance, by trying every feature against every other and every axis that can
/// separate: 1e-17 of the sizes, but for penetration of cores with edges within 1e-3 of parallel.
[[nodiscard]] long double twin_distance(const TwinShape& a, const TwinShape& b);

/// How far b must be moved along n until it is beyond a; negative if it is beyond already.
[[nodiscard]] long double twin_overlap_along(const TwinShape& a, const TwinShape& b,
                                             const LongVector& n);

/// Distance of a point from the shape, 0 inside.
[[nodiscard]] long double twin_distance(const TwinShape& shape, const LongVector& point);

/// The sum of what the shapes' extents and offset are.
[[nodiscard]] long double twin_scale(const TwinShape& a, const TwinShape& b);

}  // namespace winnow::test
