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

// How far a shape reaches along a direction, and how large the numbers were.
struct Reach {
  double far;
  double scale;
};

[[nodiscard]] Reach reach_of_points(const double* const (&column)[3], std::size_t count,
                                    const Vector3d& d) {
  Reach reach{-std::numeric_limits<double>::infinity(), 0.0};
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d terms(column[0][i] * d[0], column[1][i] * d[1], column[2][i] * d[2]);
    reach.far = std::max(reach.far, terms.sum());
    reach.scale = std::max(reach.scale, terms.cwiseAbs().sum());
  }
  return reach;
}

[[nodiscard]] Reach symmetric(double reach) {
  return {reach, reach};
}

[[nodiscard]] Reach reach(const ShapeTables& tables, ShapeId id, const Vector3d& d) {
  const std::uint32_t i = id.index();
  const double side = std::hypot(d.x(), d.y());
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
      return symmetric(s.radius * side + s.half_length * std::abs(d.z()) + s.rounding);
    }
    case ShapeKind::cone: {
      const ConeShape& s = tables.cones[i];
      const double far = std::max(s.half_length * d.z(), s.radius * side - s.half_length * d.z());
      return {far + s.rounding, s.radius * side + s.half_length * std::abs(d.z()) + s.rounding};
    }
    case ShapeKind::hull: {
      const HullShape& s = tables.hulls[i];
      const Reach core = reach_of_points(s.vertex, s.vertex_count, d);
      return {core.far + s.rounding, core.scale + s.rounding};
    }
    case ShapeKind::triangle: {
      const TriangleShape& s = tables.triangles[i];
      double columns[3][3];
      for (int v = 0; v < 3; ++v) {
        for (int axis = 0; axis < 3; ++axis) columns[axis][v] = s.vertex[v][axis];
      }
      const double* const pointers[3] = {columns[0], columns[1], columns[2]};
      const Reach core = reach_of_points(pointers, 3, d);
      return {core.far + s.rounding, core.scale + s.rounding};
    }
    case ShapeKind::half_space: {
      const HalfSpaceShape& s = tables.half_spaces[i];
      const Vector3d n(s.normal[0], s.normal[1], s.normal[2]);
      // Bounded only where its normal is the axis, to the last bit.
      if (d != n) return {std::numeric_limits<double>::infinity(), 0.0};
      return {s.offset, std::abs(s.offset)};
    }
  }
  return {0.0, 0.0};
}

// Rounded up; a reach may be infinite.
[[nodiscard]] double end(double position, double far) {
  return std::isinf(far) ? far : add_up(position, far);
}

}  // namespace

Aabb ShapePool::bounds(ShapeId id, const Pose& pose) const noexcept {
  const Matrix3d turn = rotation(pose);
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d direction = turn.row(axis);
    const Reach up = reach(tables_, id, direction);
    const Reach down = reach(tables_, id, -direction);
    const double slack = kSlack * std::max(up.scale, down.scale);
    box.max[axis] = round_up(end(pose.position[axis], up.far + slack));
    box.min[axis] = -round_up(end(-pose.position[axis], down.far + slack));
  }
  return box;
}

}  // namespace winnow
