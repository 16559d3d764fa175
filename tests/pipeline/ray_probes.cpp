#include "tests/pipeline/ray_probes.h"

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace winnow::test {
namespace {

using Eigen::Vector3d;

[[nodiscard]] double distance_to_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d edge = b - a;
  const double length = edge.squaredNorm();
  const double s = length > 0.0 ? std::clamp((p - a).dot(edge) / length, 0.0, 1.0) : 0.0;
  return (p - a - s * edge).norm();
}

[[nodiscard]] double distance_to_box(const Vector3d& p, const Vector3d& half) {
  const Vector3d q = p.cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

[[nodiscard]] double distance_to_cylinder(const Vector3d& p, double radius, double half) {
  const double u = std::hypot(p.x(), p.y()) - radius;
  const double v = std::fabs(p.z()) - half;
  return std::hypot(std::max(u, 0.0), std::max(v, 0.0)) + std::min(std::max(u, v), 0.0);
}

/// Returns the distance from a cone by the triangle that generates it.
[[nodiscard]] double distance_to_cone(const Vector3d& p, double radius, double half) {
  const Vector3d flat(std::hypot(p.x(), p.y()), p.z(), 0.0);
  const Vector3d apex(0.0, half, 0.0);
  const Vector3d rim(radius, -half, 0.0);
  const Vector3d side = Vector3d(2.0 * half, radius, 0.0).normalized();
  const double over = std::max(side.dot(flat - apex), -half - flat.y());
  if (over <= 0.0) return over;
  return std::min(distance_to_segment(flat, apex, rim),
                  distance_to_segment(flat, Vector3d(0.0, -half, 0.0), rim));
}

[[nodiscard]] double distance_to_triangle(const Vector3d& p, const Vector3d (&v)[3]) {
  const Vector3d normal = (v[1] - v[0]).cross(v[2] - v[0]);
  double nearest = std::numeric_limits<double>::infinity();
  bool over = normal.norm() > 0.0;
  for (int i = 0; i < 3; ++i) {
    const Vector3d& a = v[i];
    const Vector3d& b = v[(i + 1) % 3];
    over = over && normal.cross(b - a).dot(p - a) >= 0.0;
    nearest = std::min(nearest, distance_to_segment(p, a, b));
  }
  return over ? std::fabs(normal.normalized().dot(p - v[0])) : nearest;
}

}  // namespace

RayProbes::RayProbes() {
  for (const double r : {0.0, 0.3}) {
    add_box({1.0, 0.5, 2.0}, r);
    add_box({1.0, 0.0, 2.0}, r);
    add_box_hull({0.7, 1.3, 1.0}, r);
    add_triangle({-1.0, -1.0, 0.2}, {1.5, -0.5, -0.3}, {0.0, 1.2, 0.4}, r);
    add_cylinder(1.0, 0.7, r);
    add_cone(1.0, 0.7, r);
    add_cone(0.2, 1.5, r);
  }
  add_cylinder(1.0, 0.0, 0.0);
  add_cone(1.0, 0.0, 0.0);
  add_triangle({-1.0, -1.0, 0.0}, {0.0, 0.0, 0.0}, {2.0, 2.0, 0.0},
               0.5);  // degenerates to a segment
  add_capsule(0.4, 1.0);
  add_capsule(1.0, 0.0);
  add_half_space({0.0, 0.6, 0.8}, -0.5);
  ShapeId id;
  const Status status = pool_.add(SphereShape{1.0}).get(id);
  put(status, "sphere", id, [](const Vector3d& p) { return p.norm() - 1.0; });
}

void RayProbes::put(Status status, const std::string& name, ShapeId id,
                    std::function<double(const Vector3d&)> distance) {
  EXPECT_EQ(status, Status::ok) << name;
  if (status == Status::ok) probes_.push_back({name, id, std::move(distance)});
}

void RayProbes::add_box(const Vector3d& half, double r) {
  ShapeId id;
  const Status status = pool_.add(BoxShape{{half.x(), half.y(), half.z()}, r}).get(id);
  put(status, "box", id, [=](const Vector3d& p) { return distance_to_box(p, half) - r; });
}

void RayProbes::add_box_hull(const Vector3d& half, double r) {
  std::vector<Vector3d> points;
  for (unsigned i = 0; i < 8; ++i) {
    points.push_back({(i & 1U) != 0 ? half.x() : -half.x(), (i & 2U) != 0 ? half.y() : -half.y(),
                      (i & 4U) != 0 ? half.z() : -half.z()});
  }
  const std::vector<std::uint32_t> loops = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                            2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
  const std::vector<std::uint32_t> sizes(6, 4);
  ShapeId id;
  const Status status = pool_.add_hull(points, HullFaces{loops, sizes}, r).get(id);
  put(status, "hull", id, [=](const Vector3d& p) { return distance_to_box(p, half) - r; });
}

void RayProbes::add_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c, double r) {
  TriangleShape shape{{}, r};
  as_eigen(shape.vertex[0]) = a;
  as_eigen(shape.vertex[1]) = b;
  as_eigen(shape.vertex[2]) = c;
  ShapeId id;
  const Status status = pool_.add(shape).get(id);
  put(status, "triangle", id, [=](const Vector3d& p) {
    const Vector3d at[3] = {a, b, c};
    return distance_to_triangle(p, at) - r;
  });
}

void RayProbes::add_cylinder(double radius, double half, double r) {
  ShapeId id;
  const Status status = pool_.add(CylinderShape{radius, half, r}).get(id);
  put(status, "cylinder", id,
      [=](const Vector3d& p) { return distance_to_cylinder(p, radius, half) - r; });
}

void RayProbes::add_cone(double radius, double half, double r) {
  ShapeId id;
  const Status status = pool_.add(ConeShape{radius, half, r}).get(id);
  put(status, "cone", id, [=](const Vector3d& p) { return distance_to_cone(p, radius, half) - r; });
}

void RayProbes::add_capsule(double radius, double half) {
  ShapeId id;
  const Status status = pool_.add(CapsuleShape{radius, half}).get(id);
  put(status, "capsule", id, [=](const Vector3d& p) {
    return distance_to_segment(p, {0.0, 0.0, -half}, {0.0, 0.0, half}) - radius;
  });
}

void RayProbes::add_half_space(const Vector3d& normal, double offset) {
  ShapeId id;
  const HalfSpaceShape shape{{normal.x(), normal.y(), normal.z()}, offset};
  const Status status = pool_.add(shape).get(id);
  put(status, "half-space", id, [=](const Vector3d& p) { return p.dot(normal) - offset; });
}

}  // namespace winnow::test
