// Random pairs of shapes of two given kinds in several styles (ordinary, degenerate, on a lattice,
// of extreme sizes). Used by most tests of the narrow phase, times of impact and casts.

#include "tests/pipeline/pair_scenes.h"

#include <gtest/gtest.h>
#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace winnow::test {
namespace {

/// Generates shapes and poses of one style.
class Maker {
 public:
  Maker(PairScene& scene, PairStyle style, Random& random)
      : scene_(scene), style_(style), random_(random) {}

  void add_pair(ShapeKind a, ShapeKind b) {
    const double size_a = size();
    const double size_b =
        style_ == PairStyle::extreme_sizes ? size_a * random_.uniform(0.5, 2.0) : size();
    double reach = 0.0;
    const ShapeId shape_a = shape(a, size_a, reach);
    const ShapeId shape_b = shape(b, size_b, reach);
    const Quaternion turn_a = quaternion();
    const Quaternion turn_b = other_quaternion(turn_a);
    Pose pose_a;
    Pose pose_b;
    pose_a.orientation = turn_a;
    pose_b.orientation = turn_b;
    place(pose_a, pose_b, reach);
    const auto first = static_cast<std::uint32_t>(scene_.shapes.size());
    const std::uint32_t turned = random_.chance(0.5) ? 1 : 0;
    scene_.shapes.insert(scene_.shapes.end(), {shape_a, shape_b});
    scene_.poses.insert(scene_.poses.end(), {pose_a, pose_b});
    scene_.pairs.push_back({first + turned, first + 1 - turned});
  }

 private:
  using Quaternion = std::array<double, 4>;

  double size() {
    switch (style_) {
      case PairStyle::unequal:
        return random_.log_uniform(1e-4, 1e4);
      case PairStyle::extreme_sizes:
        return random_.log_uniform(1e-20, 1e15);
      default:
        return random_.uniform(0.5, 2.0);
    }
  }

  /// Returns a random length of a shape of this size.
  double length(double size) {
    if (style_ == PairStyle::lattice) return 0.5 * static_cast<double>(random_.below(4));
    if (style_ == PairStyle::degenerate) {
      if (random_.chance(0.25)) return 0.0;
      if (random_.chance(0.25)) return size * random_.log_uniform(1e-9, 1.0);
    }
    return size * random_.uniform(0.1, 1.0);
  }

  double rounding(double size) { return random_.chance(0.2) ? length(0.3 * size) : 0.0; }

  double coordinate(double size) {
    if (style_ == PairStyle::lattice) return 0.5 * (static_cast<double>(random_.below(7)) - 3.0);
    return size * random_.uniform(-1.0, 1.0);
  }

  Eigen::Vector3d point(double size) {
    return {coordinate(size), coordinate(size), coordinate(size)};
  }

  TriangleShape triangle(double size) {
    Eigen::Vector3d v[3] = {point(size), point(size), point(size)};
    if (style_ == PairStyle::degenerate) {
      const double along = random_.uniform(-1.0, 2.0);
      const double off = random_.chance(0.5) ? 0.0 : random_.log_uniform(1e-12, 1e-2);
      if (random_.chance(0.5)) v[2] = v[0] + (v[1] - v[0]) * along + v[2] * off;
      if (random_.chance(0.2)) v[1] = v[0];
      if (random_.chance(0.1)) v[0] = v[1] = v[2];
    }
    TriangleShape shape;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) shape.vertex[i][k] = v[i][k];
    }
    shape.rounding = rounding(size);
    return shape;
  }

  std::vector<Eigen::Vector3d> hull_points(double size) {
    std::vector<Eigen::Vector3d> points;
    const std::size_t count = 4 + random_.below(17);
    for (std::size_t i = 0; i < count; ++i) points.push_back(point(size));
    if (style_ == PairStyle::degenerate && random_.chance(0.6)) {
      const double thickness = random_.chance(0.5) ? 0.0 : random_.log_uniform(1e-8, 1e-1);
      for (Eigen::Vector3d& p : points) p.z() *= thickness;
      if (random_.chance(0.2)) {
        for (Eigen::Vector3d& p : points) p.y() = 0.0;
      }
    }
    return points;
  }

  /// Adds a user shape of a random form.
  const UserShape& user_shape(double size, const Vec3d& half) {
    UserShape& set = scene_.own.emplace_back();
    set.form = static_cast<UserShape::Form>(random_.below(4));
    std::copy_n(half.data(), 3, set.size);
    if (set.form == UserShape::corners) {
      for (const Eigen::Vector3d& x : hull_points(size)) {
        set.corner.insert(set.corner.end(), x.begin(), x.end());
      }
    }
    return set;
  }

  ShapeId shape(ShapeKind kind, double size, double& reach) {
    ShapeId id;
    Status status = Status::ok;
    const double half[3] = {length(size), length(size), length(size)};
    const double round = rounding(size);
    reach += std::hypot(half[0], half[1], half[2]) + round;
    switch (kind) {
      case ShapeKind::sphere:
        status = scene_.pool.add(SphereShape{half[0]}).get(id);
        break;
      case ShapeKind::capsule:
        status = scene_.pool.add(CapsuleShape{half[0], half[1]}).get(id);
        break;
      case ShapeKind::box:
        status = scene_.pool.add(BoxShape{{half[0], half[1], half[2]}, round}).get(id);
        break;
      case ShapeKind::cylinder:
        status = scene_.pool.add(CylinderShape{half[0], half[1], round}).get(id);
        break;
      case ShapeKind::cone:
        status = scene_.pool.add(ConeShape{half[0], half[1], round}).get(id);
        break;
      case ShapeKind::triangle:
        status = scene_.pool.add(triangle(size)).get(id);
        break;
      case ShapeKind::hull:
        status = scene_.pool.add_hull(hull_points(size), round).get(id);
        break;
      case ShapeKind::half_space: {
        const Eigen::Vector3d n = point(1.0) + Eigen::Vector3d(0.0, 0.0, 10.0);
        status = scene_.pool.add(HalfSpaceShape{{n.x(), n.y(), n.z()}, coordinate(size)}).get(id);
        break;
      }
      case ShapeKind::ellipsoid:
        status = scene_.pool.add(EllipsoidShape{{half[0], half[1], half[2]}, round}).get(id);
        break;
      case ShapeKind::tapered_capsule:
        status = scene_.pool.add(TaperedCapsuleShape{{half[0], half[1]}, half[2]}).get(id);
        break;
      case ShapeKind::support:
        status = scene_.pool.add(shape_of(user_shape(size, half), round)).get(id);
        break;
      default:
        status = Status::unsupported;
    }
    EXPECT_EQ(status, Status::ok);
    return id;
  }

  Quaternion quaternion() {
    if (style_ == PairStyle::lattice) {
      static constexpr Quaternion kTurns[] = {{1, 0, 0, 0}, {1, 1, 0, 0},  {0, 0, 1, 0},
                                              {1, 1, 1, 1}, {1, 0, 0, -1}, {2, 1, 0, 0},
                                              {1, 2, 2, 0}, {3, 0, 1, 1}};
      return kTurns[random_.chance(0.5) ? 0 : random_.below(std::size(kTurns))];
    }
    Quaternion q;
    for (double& x : q) x = random_.uniform(-1.0, 1.0);
    return q;
  }

  /// Returns the orientation of b, given the orientation of a.
  Quaternion other_quaternion(const Quaternion& a) {
    Quaternion q = quaternion();
    if (style_ == PairStyle::degenerate && random_.chance(0.4)) q = a;
    if (style_ == PairStyle::nearly_parallel) {
      const double angle = random_.chance(0.3) ? 0.0 : random_.log_uniform(1e-12, 1e-2);
      for (std::size_t i = 0; i < 4; ++i) q[i] = a[i] + angle * q[i];
    }
    return q;
  }

  /// Sets positions so that about half of the pairs overlap.
  void place(Pose& a, Pose& b, double reach) {
    Eigen::Vector3d away = point(1.0);
    if (style_ != PairStyle::lattice) {
      away *= reach * random_.uniform(0.1, 1.1) / std::max(away.norm(), 1e-3);
      if (style_ == PairStyle::degenerate && random_.chance(0.2)) away.setZero();
    }
    const double origin = random_.chance(0.5) ? 0.0 : random_.uniform(-2.0, 2.0) * reach;
    for (int i = 0; i < 3; ++i) {
      a.position[i] = style_ == PairStyle::lattice ? std::floor(origin) : origin;
      b.position[i] = a.position[i] + away[i];
    }
  }

  PairScene& scene_;
  PairStyle style_;
  Random& random_;
};

/// Returns the extent of one shape about the origin of its frame.
double extent_of(const ShapeTables& tables, ShapeId id) {
  const std::uint32_t i = id.index();
  switch (id.kind()) {
    case ShapeKind::sphere:
      return tables.spheres[i].radius;
    case ShapeKind::capsule:
      return tables.capsules[i].radius + tables.capsules[i].half_length;
    case ShapeKind::box: {
      const BoxShape& box = tables.boxes[i];
      return std::hypot(box.half[0], box.half[1], box.half[2]) + box.rounding;
    }
    case ShapeKind::cylinder: {
      const CylinderShape& c = tables.cylinders[i];
      return c.radius + c.half_length + c.rounding;
    }
    case ShapeKind::cone: {
      const ConeShape& c = tables.cones[i];
      return c.radius + c.half_length + c.rounding;
    }
    case ShapeKind::hull: {
      const HullShape& hull = tables.hulls[i];
      return std::hypot(hull.center[0], hull.center[1], hull.center[2]) + hull.radius +
             hull.rounding;
    }
    case ShapeKind::triangle: {
      const TriangleShape& triangle = tables.triangles[i];
      double largest = 0.0;
      for (const auto& v : triangle.vertex) {
        largest = std::max(largest, std::hypot(v[0], v[1], v[2]));
      }
      return largest + triangle.rounding;
    }
    case ShapeKind::half_space:
      return std::abs(tables.half_spaces[i].offset);
    case ShapeKind::ellipsoid:
      return *std::ranges::max_element(tables.ellipsoids[i].radius) + tables.ellipsoids[i].rounding;
    case ShapeKind::tapered_capsule: {
      const TaperedCapsuleShape& taper = tables.tapered_capsules[i];
      return taper.half_length + std::max(taper.radius[0], taper.radius[1]);
    }
    case ShapeKind::support:
      return tables.supports[i].radius + tables.supports[i].rounding;
    default:
      break;
  }
  return 0.0;
}

}  // namespace

double extent(const PairScene& scene, BodyPair pair) {
  return extent_of(scene.pool.tables(), scene.shapes[pair.a]) +
         extent_of(scene.pool.tables(), scene.shapes[pair.b]);
}

const char* to_string(PairStyle style) {
  switch (style) {
    case PairStyle::ordinary:
      return "ordinary";
    case PairStyle::degenerate:
      return "degenerate";
    case PairStyle::lattice:
      return "lattice";
    case PairStyle::unequal:
      return "unequal";
    case PairStyle::nearly_parallel:
      return "nearly_parallel";
    case PairStyle::extreme_sizes:
      return "extreme_sizes";
  }
  return "";
}

std::vector<ShapeKind> polytope_kinds() {
  return {ShapeKind::sphere, ShapeKind::capsule, ShapeKind::box, ShapeKind::hull,
          ShapeKind::triangle};
}

std::vector<ShapeKind> all_kinds() {
  std::vector<ShapeKind> kinds;
  for (const ShapeKind kind : kConvexKinds) {
    if (kind > ShapeKind::half_space) break;
    kinds.push_back(kind);
  }
  return kinds;
}

void add_pairs(PairScene& scene, ShapeKind a, ShapeKind b, PairStyle style, std::size_t count,
               Random& random) {
  Maker maker(scene, style, random);
  for (std::size_t i = 0; i < count; ++i) maker.add_pair(a, b);
}

}  // namespace winnow::test
