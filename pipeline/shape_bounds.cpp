#include <winnow/core/rounding.h>
#include <winnow/pipeline/shape_pool.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Of the reach along an axis, for the rounding of the rotation and of the sums below.
constexpr double kSlack = 1e-14;

[[nodiscard]] Matrix3d rotation(const Pose& pose) {
  // Scaled by the largest component first, so that no square leaves double.
  Eigen::Quaterniond q(pose.orientation[0], pose.orientation[1], pose.orientation[2],
                       pose.orientation[3]);
  q.coeffs() /= q.coeffs().cwiseAbs().maxCoeff();
  return q.normalized().toRotationMatrix();
}

// How far a shape reaches along a direction and against it, and how large the numbers were.
struct Reach {
  double up;
  double down;
  double scale;
};

[[nodiscard]] Reach reach_of_points(const double* const (&column)[3], std::size_t count,
                                    const Vector3d& d) {
  double most = -std::numeric_limits<double>::infinity();
  double least = -most;
  double scale = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d terms(column[0][i] * d[0], column[1][i] * d[1], column[2][i] * d[2]);
    const double sum = terms.sum();
    most = std::max(most, sum);
    least = std::min(least, sum);
    scale = std::max(scale, terms.cwiseAbs().sum());
  }
  return {most, -least, scale};
}

[[nodiscard]] Reach symmetric(double reach) {
  return {reach, reach, reach};
}

[[nodiscard]] Reach grown(const Reach& core, double rounding) {
  return {core.up + rounding, core.down + rounding, core.scale + rounding};
}

// Of a disc about z.
[[nodiscard]] double side(const Vector3d& d) {
  return std::sqrt(d.x() * d.x() + d.y() * d.y());
}

[[nodiscard]] Reach reach(const ShapeTables& tables, ShapeId id, const Vector3d& d) {
  const std::uint32_t i = id.index();
  switch (id.kind()) {
    case ShapeKind::sphere:
      return symmetric(tables.spheres[i].radius);
    case ShapeKind::capsule: {
      const CapsuleShape& s = tables.capsules[i];
      return symmetric(s.radius + s.half_length * std::abs(d.z()));
    }
    case ShapeKind::box: {
      const BoxShape& s = tables.boxes[i];
      return symmetric(s.half[0] * std::abs(d.x()) + s.half[1] * std::abs(d.y()) +
                       s.half[2] * std::abs(d.z()) + s.rounding);
    }
    case ShapeKind::cylinder: {
      const CylinderShape& s = tables.cylinders[i];
      return symmetric(s.radius * side(d) + s.half_length * std::abs(d.z()) + s.rounding);
    }
    case ShapeKind::cone: {
      const ConeShape& s = tables.cones[i];
      const double disc = s.radius * side(d);
      const double apex = s.half_length * d.z();
      return {std::max(apex, disc - apex) + s.rounding, std::max(-apex, disc + apex) + s.rounding,
              disc + std::abs(apex) + s.rounding};
    }
    case ShapeKind::hull: {
      const HullShape& s = tables.hulls[i];
      return grown(reach_of_points(s.vertex, s.vertex_count, d), s.rounding);
    }
    case ShapeKind::triangle: {
      const TriangleShape& s = tables.triangles[i];
      double columns[3][3];
      for (int v = 0; v < 3; ++v) {
        for (int axis = 0; axis < 3; ++axis) columns[axis][v] = s.vertex[v][axis];
      }
      const double* const pointers[3] = {columns[0], columns[1], columns[2]};
      return grown(reach_of_points(pointers, 3, d), s.rounding);
    }
    case ShapeKind::half_space: {
      const HalfSpaceShape& s = tables.half_spaces[i];
      const Vector3d n(s.normal[0], s.normal[1], s.normal[2]);
      // Bounded only where its normal is the axis, to the last bit.
      constexpr double kFar = std::numeric_limits<double>::infinity();
      return {d == n ? s.offset : kFar, d == -n ? s.offset : kFar,
              d == n || d == -n ? std::abs(s.offset) : 0.0};
    }
  }
  return {};
}

// Rounded up; a reach may be infinite.
[[nodiscard]] double end(double position, double far) {
  return std::isinf(far) ? far : add_up(position, far);
}

}  // namespace

Aabb ShapePool::bounds(ShapeId id, const Pose& pose) const noexcept {
  // Balls need no turn.
  const Matrix3d turn =
      id.kind() == ShapeKind::sphere ? Matrix3d(Matrix3d::Identity()) : rotation(pose);
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    const Reach far = reach(tables_, id, turn.row(axis));
    const double slack = kSlack * far.scale;
    box.max[axis] = round_up(end(pose.position[axis], far.up + slack));
    box.min[axis] = -round_up(end(-pose.position[axis], far.down + slack));
  }
  return box;
}

}  // namespace winnow
