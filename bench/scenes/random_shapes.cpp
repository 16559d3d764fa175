// Draws random shapes and orientations for pair_set.cpp and moving_pairs.cpp.

#include "bench/scenes/random_shapes.h"

#include "bench/common/need.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace winnow::bench {

Eigen::Vector3d random_unit(Random& random) {
  for (;;) {
    const Eigen::Vector3d v(random.in(-1.0, 1.0), random.in(-1.0, 1.0), random.in(-1.0, 1.0));
    const double square = v.squaredNorm();
    if (square > 1e-4 && square <= 1.0) return v / std::sqrt(square);
  }
}

Eigen::Vector3d random_in_ball(Random& random, double radius) {
  for (;;) {
    const Eigen::Vector3d v(random.in(-1.0, 1.0), random.in(-1.0, 1.0), random.in(-1.0, 1.0));
    if (v.squaredNorm() <= 1.0) return radius * v;
  }
}

void turn_at_random(Random& random, Pose& pose) {
  for (;;) {
    double square = 0.0;
    for (double& q : pose.orientation) {
      q = random.in(-1.0, 1.0);
      square += q * q;
    }
    if (square < 1e-2 || square > 1.0) continue;
    for (double& q : pose.orientation) q /= std::sqrt(square);
    return;
  }
}

void turn_upright(Random& random, Pose& pose) {
  for (;;) {
    const double w = random.in(-1.0, 1.0);
    const double z = random.in(-1.0, 1.0);
    const double square = w * w + z * z;
    if (square < 1e-2 || square > 1.0) continue;
    const double scale = 1.0 / std::sqrt(square);
    pose.orientation = {scale * w, 0.0, 0.0, scale * z};
    return;
  }
}

void turn_from(Random& random, const Pose& from, double angle, Pose& pose) {
  const Eigen::Vector3d half = 0.5 * angle * random_unit(random);
  const Eigen::Quaterniond turn(1.0, half.x(), half.y(), half.z());
  pose.orientation = Quaternion(turn.normalized()) * from.orientation;
}

ShapeSource::ShapeSource(ShapePool& pool, const ShapeStyle& style, Random& random)
    : pool_(pool), style_(style), random_(random) {
  if (style_.kind != ShapeKind::hull) return;
  for (std::uint32_t i = 0; i < style_.hulls; ++i) hulls_.push_back(draw_hull());
}

template <typename Shape>
DrawnShape ShapeSource::put(const Shape& shape, double radius) {
  DrawnShape drawn{{}, radius};
  drawn.id = need(pool_.add(shape), "a shape");
  return drawn;
}

DrawnShape ShapeSource::draw_triangle() {
  Eigen::Matrix3d corners;
  for (int i = 0; i < 3; ++i) corners.col(i) = random_unit(random_) * length(0.5, 1.0);
  if (style_.upright) corners.col(1).head<2>() = corners.col(0).head<2>();
  if (style_.thinness < 1.0) {
    const Eigen::Vector3d foot = 0.5 * (corners.col(0) + corners.col(1));
    corners.col(2) = foot + style_.thinness * (corners.col(2) - foot);
  }
  corners.colwise() -= Eigen::Vector3d(corners.rowwise().mean());
  TriangleShape triangle;
  for (int i = 0; i < 3; ++i) triangle.vertex[i] = corners.col(i);
  return put(triangle, corners.colwise().norm().maxCoeff());
}

DrawnShape ShapeSource::draw_lens() {
  const double rim = length(0.25, 1.0);
  const double half = rim * random_.in(0.25, 0.75);
  const double radius = 0.5 * (rim * (rim / half) + half);
  const Lens& lens = style_.lenses->emplace_back(Lens{radius, radius - half});
  return put(shape_of(lens), rim_of(lens));
}

std::vector<Eigen::Vector3d> ShapeSource::draw_corners() {
  const Eigen::Array3d axes(length(0.5, 1.0), length(0.5, 1.0), length(0.5, 1.0));
  std::vector<Eigen::Vector3d> points;
  if (style_.upright) {
    // A regular prism, stretched by the axes.
    constexpr double kTurn = 6.283185307179586;
    const std::uint32_t sides = style_.hull_vertices / 2;
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double angle = kTurn * i / sides;
      for (const double end : {-0.5, 0.5}) {
        points.emplace_back(axes.x() * std::cos(angle), axes.x() * std::sin(angle), axes.z() * end);
      }
    }
    return points;
  }
  for (std::uint32_t i = 0; i < style_.hull_vertices; ++i) {
    points.emplace_back(random_unit(random_).array() * axes);
  }
  return points;
}

DrawnShape ShapeSource::draw_hull() {
  const std::vector<Eigen::Vector3d> points = draw_corners();
  DrawnShape drawn;
  for (const Eigen::Vector3d& point : points) drawn.radius = std::max(drawn.radius, point.norm());
  drawn.id = need(pool_.add_hull(points, 0.0), "a hull");
  return drawn;
}

DrawnShape ShapeSource::draw() {
  switch (style_.kind) {
    case ShapeKind::sphere: {
      const double radius = length(0.25, 1.0);
      return put(SphereShape{radius}, radius);
    }
    case ShapeKind::capsule: {
      const CapsuleShape capsule{length(0.125, 0.5), length(0.25, 1.0)};
      return put(capsule, capsule.radius + capsule.half_length);
    }
    case ShapeKind::box: {
      const Eigen::Vector3d half(length(0.25, 1.0), length(0.25, 1.0), length(0.25, 1.0));
      return put(BoxShape{half, 0.0}, half.norm());
    }
    case ShapeKind::cylinder: {
      const CylinderShape cylinder{length(0.25, 1.0), length(0.25, 1.0), 0.0};
      return put(cylinder, std::hypot(cylinder.radius, cylinder.half_length));
    }
    case ShapeKind::cone: {
      const ConeShape cone{length(0.25, 1.0), length(0.25, 1.0), 0.0};
      return put(cone, std::hypot(cone.radius, cone.half_length));
    }
    case ShapeKind::ellipsoid: {
      const Eigen::Vector3d radius(length(0.25, 1.0), length(0.25, 1.0), length(0.25, 1.0));
      return put(EllipsoidShape{radius}, radius.maxCoeff());
    }
    case ShapeKind::tapered_capsule: {
      const TaperedCapsuleShape taper{{length(0.125, 0.5), length(0.125, 0.5)}, length(0.25, 1.0)};
      return put(taper, taper.half_length + std::max(taper.radius[0], taper.radius[1]));
    }
    case ShapeKind::half_space: {
      const HalfSpaceShape half_space{random_unit(random_), 0.0};
      return put(half_space, length(0.25, 1.0));
    }
    case ShapeKind::triangle:
      return draw_triangle();
    case ShapeKind::support:
      return draw_lens();
    case ShapeKind::hull:
      return hulls_[random_.below(static_cast<std::uint32_t>(hulls_.size()))];
    default:
      throw std::runtime_error(std::string("no pairs are drawn of ") + to_string(style_.kind));
  }
}

}  // namespace winnow::bench
