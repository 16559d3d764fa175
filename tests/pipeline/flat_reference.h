#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>

#include <Eigen/Core>
#include <vector>

namespace winnow::test {

using LongVector = Eigen::Matrix<long double, 3, 1>;

/// A box or triangle in world space: the vertices of its core, the directions of its edges, and the
/// normals of its faces and their sides.
struct FlatReference {
  std::vector<LongVector> vertices;
  std::vector<LongVector> edges;
  std::vector<LongVector> normals;
  long double rounding = 0.0L;

  FlatReference(const BoxShape& box, const Pose& pose, const double origin[3]);
  FlatReference(const TriangleShape& triangle, const Pose& pose, const double origin[3]);
  /// A single point.
  explicit FlatReference(const LongVector& point) : vertices{point} {}
};

/// Returns the signed distance: the largest separation along all directions in which features can
/// face each other, less the roundings.
[[nodiscard]] long double signed_distance(const FlatReference& a, const FlatReference& b);

/// Returns the separation of the shapes along a direction of any length, less the roundings.
[[nodiscard]] long double separation(const FlatReference& a, const FlatReference& b,
                                     const LongVector& axis);

}  // namespace winnow::test
