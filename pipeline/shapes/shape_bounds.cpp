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

// Of points in columns that are padded to whole blocks by copies of one of them, none farther from
// the origin than `radius`: no product with a unit vector is larger.
[[nodiscard]] Reach reach_of_columns(const double* const (&column)[3], std::size_t count,
                                     double radius, const Vector3d& d) {
  // As many as keep both ends of a block in registers.
  constexpr std::size_t kBlock = 4;
  double most[kBlock];
  double least[kBlock];
  std::fill_n(most, kBlock, -std::numeric_limits<double>::infinity());
  std::fill_n(least, kBlock, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < count; i += kBlock) {
    for (std::size_t k = 0; k < kBlock; ++k) {
      const double at = column[0][i + k] * d[0] + column[1][i + k] * d[1] + column[2][i + k] * d[2];
      most[k] = at > most[k] ? at : most[k];
      least[k] = at < least[k] ? at : least[k];
    }
  }
  return {*std::max_element(most, most + kBlock), -*std::min_element(least, least + kBlock),
          radius};
}

[[nodiscard]] Reach reach_of_corners(const double (&corner)[3][3], const Vector3d& d) {
  Reach reach{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
              0.0};
  for (const auto& v : corner) {
    const Vector3d terms(v[0] * d[0], v[1] * d[1], v[2] * d[2]);
    const double at = terms.sum();
    reach.up = std::max(reach.up, at);
    reach.down = std::max(reach.down, -at);
    reach.scale = std::max(reach.scale, terms.cwiseAbs().sum());
  }
  return reach;
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
      const double radius = Vector3d(s.center).norm() + s.radius;
      return grown(reach_of_columns(s.vertex, s.vertex_count, radius, d), s.rounding);
    }
    case ShapeKind::triangle: {
      const TriangleShape& s = tables.triangles[i];
      return grown(reach_of_corners(s.vertex, d), s.rounding);
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
