#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>

#include <Eigen/Core>
#include <vector>

namespace winnow::test {

using LongVector = Eigen::Matrix<long double, 3, 1>;

/// A box or triangle where it stands, plainly: its core's vertices, the directions of its edges and
/// the normals of its faces and of their sides.
struct FlatTwin {
  std::vector<LongVector> vertices;
  std::vector<LongVector> edges;
  std::vector<LongVector> normals;
  long double rounding = 0.0L;

  FlatTwin(const BoxShape& box, const Pose& pose, const double origin[3]);
  FlatTwin(const TriangleShape& triangle, const Pose& pose, const double origin[3]);
  /// One point.
  explicit FlatTwin(const LongVector& point) : vertices{point} {}
};

/// The distance, negative by the depth: the largest separation along all directions in which
/// features of any kind can face each other, less the roundings.
[[nodiscard]] long double signed_distance(const FlatTwin& a, const FlatTwin& b);

/// How far the shapes are apart along a direction of any length, less the roundings.
[[nodiscard]] long double separation(const FlatTwin& a, const FlatTwin& b, const LongVector& axis);

}  // namespace winnow::test
