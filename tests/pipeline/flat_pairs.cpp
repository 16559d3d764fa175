// Random pairs of shapes with flat cores: coplanar, parallel or collinear, at random scales and
// rounded or not. Used by flat_cores_test.cpp.

#include "tests/pipeline/flat_pairs.h"
#include "tests/support/answers.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace winnow::test {
namespace {

using Turn = Eigen::Quaterniond;

// Not normalized, so that they are exact. Poses need no unit quaternions.
const Turn kUpright(1.0, 0.0, 0.0, 0.0);
const Turn kZToX(1.0, 0.0, 1.0, 0.0);  // maps z to x
const Turn kOnSide(1.0, 1.0, 0.0, 0.0);

/// A shape, and the turn that puts its core in the plane z = 0, along x if it is a segment.
struct ShapeInPlane {
  ShapeId id;
  Turn turn = kUpright;
};

/// Generates shapes and poses from random numbers.
class FlatMaker {
 public:
  FlatMaker(PairScene& scene, Random& random) : scene_(scene), random_(random) {}

  void add_pair(ShapeKind a, ShapeKind b) {
    on_lattice_ = random_.chance(0.4);
    in_line_ = random_.chance(0.2);
    const Turn all = common_turn();
    const double unit = unit_of_length();
    const double origin = random_.chance(0.5) ? 0.0 : unit * random_.uniform(-30.0, 30.0);
    const double size_a = unit * (on_lattice_ ? 1.0 : random_.uniform(0.5, 2.0));
    const double size_b = random_.chance(0.7) ? size_a : size_a * random_.log_uniform(1e-3, 1e3);
    const Eigen::Vector3d start(origin, -origin, 0.5 * origin);
    const auto first = static_cast<std::uint32_t>(scene_.shapes.size());
    put(shape_in_plane(a, size_a), kUpright, all, start);
    put(shape_in_plane(b, size_b), turn_in_plane() * tilt(), all,
        start + all.normalized() * way(size_a));
    scene_.pairs.push_back({first, first + 1});
    scene_.pairs.push_back({first + 1, first});
  }

 private:
  double unit_of_length() {
    if (random_.chance(0.6)) return 1.0;
    const double unit = random_.log_uniform(1e-12, 1e12);
    return on_lattice_ ? std::exp2(std::round(std::log2(unit))) : unit;
  }
  double length(double size) {
    if (on_lattice_) return size * 0.5 * static_cast<double>(1 + random_.below(3));
    return size * random_.uniform(0.1, 1.0);
  }
  double rounding(double size) {
    if (random_.chance(0.5)) return 0.0;
    return on_lattice_ ? 0.25 * size : size * random_.log_uniform(1e-6, 0.5);
  }
  double coordinate(double size) {
    if (on_lattice_) return size * 0.5 * (static_cast<double>(random_.below(7)) - 3.0);
    return size * random_.uniform(-1.0, 1.0);
  }

  /// Returns 0 for a point, 1 for a segment, 2 for a flat core, 3 for a solid.
  int dimension() {
    if (in_line_) return random_.chance(0.2) ? 0 : 1;
    const double chosen = random_.unit();
    return chosen < 0.1 ? 0 : chosen < 0.3 ? 1 : chosen < 0.9 ? 2 : 3;
  }

  /// Returns corners of a core in the plane.
  std::vector<Eigen::Vector3d> corners(int dimension, std::size_t count, double size) {
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < count; ++i) {
      const double x = coordinate(size);
      points.emplace_back(x, dimension > 1 ? coordinate(size) : 0.0,
                          dimension > 2 ? coordinate(size) : 0.0);
    }
    if (dimension == 0) std::fill(points.begin(), points.end(), points.front());
    return points;
  }

  template <typename Shape>
  ShapeInPlane added(const Shape& shape, const Turn& turn) {
    ShapeInPlane made{{}, turn};
    made.id = expect_ok(scene_.pool.add(shape));
    return made;
  }

  ShapeInPlane box(int d, double size, double round) {
    double half[3] = {d > 0 ? length(size) : 0.0, d > 1 ? length(size) : 0.0,
                      d > 2 ? length(size) : 0.0};
    if (random_.chance(0.5)) return added(BoxShape{{half[0], half[1], half[2]}, round}, kUpright);
    if (random_.chance(0.5)) return added(BoxShape{{half[2], half[1], half[0]}, round}, kZToX);
    return added(BoxShape{{half[0], half[2], half[1]}, round}, kOnSide);
  }

  template <typename Shape>
  ShapeInPlane revolved(int d, double size, double round) {
    const double radius = d > 1 ? length(size) : 0.0;
    const double half_length = d == 1 || d == 3 ? length(size) : 0.0;
    return added(Shape{radius, half_length, round}, d == 1 ? kZToX : kUpright);
  }

  ShapeInPlane triangle(int d, double size, double round) {
    TriangleShape shape;
    const auto points = corners(std::min(d, 2), 3, size);
    for (std::size_t i = 0; i < 3; ++i) {
      shape.vertex[i] = points[i];
    }
    shape.rounding = round;
    return added(shape, kUpright);
  }

  ShapeInPlane hull(int d, double size, double round) {
    ShapeInPlane made;
    const auto points = corners(d, 1 + random_.below(12), size);
    made.id = expect_ok(scene_.pool.add_hull(points, round));
    return made;
  }

  ShapeInPlane own(int d, double size, double round) {
    UserShape& set = scene_.own.emplace_back();
    set.form = static_cast<UserShape::Form>(random_.below(4));
    // The axis of a drum is z. A drum that is a segment is turned to x.
    const bool is_turned = set.form == UserShape::drum && d == 1;
    for (int k = 0; k < std::min(d, 3); ++k) set.size[is_turned ? 2 - k : k] = length(size);
    if (set.form == UserShape::corners) {
      for (const Eigen::Vector3d& x : corners(d, 1 + random_.below(8), size)) {
        set.corner.insert(set.corner.end(), x.begin(), x.end());
      }
    }
    return added(shape_of(set, round), is_turned ? kZToX : kUpright);
  }

  ShapeInPlane shape_in_plane(ShapeKind kind, double size) {
    const int d = dimension();
    const double round = rounding(size);
    const double along = d > 0 ? length(size) : 0.0;
    switch (kind) {
      case ShapeKind::sphere:
        return added(SphereShape{round}, kUpright);
      case ShapeKind::capsule:
        return added(CapsuleShape{round, along}, kZToX);
      case ShapeKind::box:
        return box(d, size, round);
      case ShapeKind::cylinder:
        return revolved<CylinderShape>(d, size, round);
      case ShapeKind::cone:
        return revolved<ConeShape>(d, size, round);
      case ShapeKind::hull:
        return hull(d, size, round);
      case ShapeKind::triangle:
        return triangle(d, size, round);
      case ShapeKind::half_space:
        return added(HalfSpaceShape{{0.0, 0.0, 1.0}, 0.0}, kUpright);
      case ShapeKind::ellipsoid:
        return added(
            EllipsoidShape{{along, d > 1 ? length(size) : 0.0, d > 2 ? length(size) : 0.0}, round},
            kUpright);
      case ShapeKind::tapered_capsule:
        return added(
            TaperedCapsuleShape{{round, random_.chance(0.5) ? round : rounding(size)}, along},
            kZToX);
      default:
        return own(d, size, round);
    }
  }

  /// Returns a rotation of both shapes.
  Turn common_turn() {
    static const Turn kTurns[] = {{1, 0, 0, 0}, {1, 1, 0, 0}, {0, 0, 1, 0},
                                  {1, 1, 1, 1}, {1, 2, 2, 0}, {3, 0, 1, 1}};
    if (random_.chance(0.5)) return kTurns[random_.below(std::size(kTurns))];
    return {random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 1.0), random_.uniform(-1.0, 1.0),
            random_.uniform(-1.0, 1.0)};
  }

  Turn turn_in_plane() {
    static const Turn kTurns[] = {{1, 0, 0, 0}, {1, 0, 0, 1}, {0, 0, 0, 1}, {1, 0, 0, -1}};
    if (in_line_) return kTurns[2 * random_.below(2)];
    if (on_lattice_ || random_.chance(0.4)) return kTurns[random_.below(4)];
    const double half = random_.uniform(0.0, std::numbers::pi);
    return {std::cos(half), 0.0, 0.0, std::sin(half)};
  }

  /// Returns a rotation by up to 0.1 out of the plane, in most cases none.
  Turn tilt() {
    if (random_.chance(0.7)) return kUpright;
    const double angle = random_.log_uniform(1e-17, 0.1);
    const double way = random_.uniform(0.0, 2.0 * std::numbers::pi);
    return {1.0, angle * std::cos(way), angle * std::sin(way), 0.0};
  }

  /// Returns the offset from a to b.
  Eigen::Vector3d way(double size) {
    if (random_.chance(0.1)) return {0.0, 0.0, 0.0};
    const double reach = on_lattice_ ? 1.0 : 2.0;
    const double above = random_.chance(0.7)   ? 0.0
                         : random_.chance(0.5) ? random_.log_uniform(1e-17, 1.0)
                                               : coordinate(1.0);
    return {coordinate(reach * size), in_line_ ? 0.0 : coordinate(reach * size), above * size};
  }

  void put(const ShapeInPlane& shape, const Turn& own, const Turn& all, const Eigen::Vector3d& at) {
    const Turn turn = all * own * shape.turn;
    scene_.shapes.push_back(shape.id);
    Pose pose;
    pose.position = at;
    const double orientation[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
    pose.orientation = orientation;
    scene_.poses.push_back(pose);
  }

  PairScene& scene_;
  Random& random_;
  bool on_lattice_ = false;
  bool in_line_ = false;
};

}  // namespace

void add_flat_pairs(PairScene& scene, ShapeKind a, ShapeKind b, std::size_t count, Random& random) {
  FlatMaker maker(scene, random);
  for (std::size_t i = 0; i < count; i += 2) maker.add_pair(a, b);
}

}  // namespace winnow::test
