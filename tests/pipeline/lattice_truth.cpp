// Reference verdicts for exact_overlap on small integer shapes, in integer arithmetic: all points,
// segments and triangles of the Minkowski difference. Used by exact_test.cpp.

#include "tests/pipeline/lattice_truth.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

namespace winnow::test {
namespace {

__extension__ using Integer = __int128;

struct Vector {
  Integer x = 0;
  Integer y = 0;
  Integer z = 0;
  friend bool operator<(const Vector& a, const Vector& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  }
};

[[nodiscard]] Vector operator-(const Vector& a, const Vector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[nodiscard]] Vector operator*(Integer s, const Vector& a) {
  return {s * a.x, s * a.y, s * a.z};
}
[[nodiscard]] Integer dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] bool is_zero(const Vector& a) {
  return a.x == 0 && a.y == 0 && a.z == 0;
}

[[nodiscard]] Vector vector_of(double x, double y, double z) {
  return {std::lround(x), std::lround(y), std::lround(z)};
}

[[nodiscard]] std::vector<Vector> core(const ShapeTables& tables, ShapeId id, Integer& rounding) {
  std::vector<Vector> points;
  if (id.kind() == ShapeKind::sphere) {
    rounding = std::lround(tables.spheres[id.index()].radius);
    points.push_back({});
  } else if (id.kind() == ShapeKind::capsule) {
    const CapsuleShape& capsule = tables.capsules[id.index()];
    rounding = std::lround(capsule.radius);
    for (const int side : {-1, 1}) points.push_back(vector_of(0, 0, side * capsule.half_length));
  } else if (id.kind() == ShapeKind::box) {
    const BoxShape& box = tables.boxes[id.index()];
    rounding = std::lround(box.rounding);
    for (const int x : {-1, 1}) {
      for (const int y : {-1, 1}) {
        for (const int z : {-1, 1}) {
          points.push_back(vector_of(x * box.half[0], y * box.half[1], z * box.half[2]));
        }
      }
    }
  } else if (id.kind() == ShapeKind::triangle) {
    const TriangleShape& triangle = tables.triangles[id.index()];
    rounding = std::lround(triangle.rounding);
    for (const auto& v : triangle.vertex) points.push_back(vector_of(v[0], v[1], v[2]));
  } else {
    const HullShape& hull = tables.hulls[id.index()];
    rounding = std::lround(hull.rounding);
    for (std::uint32_t i = 0; i < hull.vertex_count; ++i) {
      points.push_back(vector_of(hull.vertex[0][i], hull.vertex[1][i], hull.vertex[2][i]));
    }
  }
  return points;
}

struct Turn {
  explicit Turn(const Pose& pose)
      : w(std::lround(pose.orientation[0])),
        v(vector_of(pose.orientation[1], pose.orientation[2], pose.orientation[3])),
        square(w * w + dot(v, v)) {}
  /// Returns the rotation of p times the squared length of the quaternion: p (w^2 - v^2) + 2 v (v
  /// p) + 2 w v x p.
  [[nodiscard]] Vector operator()(const Vector& p) const {
    const Vector turned = cross(v, p);
    const Integer along = 2 * dot(v, p);
    const Integer keep = w * w - dot(v, v);
    return {keep * p.x + along * v.x + 2 * w * turned.x,
            keep * p.y + along * v.y + 2 * w * turned.y,
            keep * p.z + along * v.z + 2 * w * turned.z};
  }
  Integer w;
  Vector v;
  Integer square;
};

/// The origin is outside the hull of w if a plane through the origin has all points on one side. It
/// suffices to test planes spanned by two of the points, unless all points are coplanar.
[[nodiscard]] bool origin_is_inside(const std::vector<Vector>& w) {
  bool solid = false;
  for (std::size_t i = 0; i < w.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const Vector normal = cross(w[i], w[k]);
      if (is_zero(normal)) continue;
      bool above = false;
      bool below = false;
      for (const Vector& p : w) {
        const Integer height = dot(normal, p);
        above = above || height > 0;
        below = below || height < 0;
      }
      if (!above || !below) return false;
      solid = true;
    }
  }
  return solid;
}

/// Sign of (least distance of the origin from points, segments and triangles) - sqrt(square).
class Nearest {
 public:
  explicit Nearest(Integer square) : square_(square) {}

  void point(const Vector& a) { update_sign(dot(a, a), 1); }
  void segment(const Vector& a, const Vector& b) {
    const Vector edge = b - a;
    const Integer length = dot(edge, edge);
    if (dot(a, edge) >= 0 || dot(b, edge) <= 0) return;
    const Vector area = cross(a, b);
    update_sign(dot(area, area), length);
  }
  void triangle(const Vector& a, const Vector& b, const Vector& c) {
    const Vector normal = cross(b - a, c - a);
    if (dot(normal, cross(b, c)) <= 0 || dot(normal, cross(c, a)) <= 0 ||
        dot(normal, cross(a, b)) <= 0) {
      return;
    }
    const Integer height = dot(normal, a);
    update_sign(height * height, dot(normal, normal));
  }
  [[nodiscard]] int sign() const { return sign_; }

 private:
  void update_sign(Integer numerator, Integer denominator) {
    const Integer rest = numerator - square_ * denominator;
    sign_ = std::min(sign_, (rest > 0) - (rest < 0));
  }
  Integer square_;
  int sign_ = 1;
};

}  // namespace

ExactVerdict lattice_truth(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
                           const Pose& pose_b) {
  Integer rounding_a = 0;
  Integer rounding_b = 0;
  const std::vector<Vector> core_a = core(tables, a, rounding_a);
  const std::vector<Vector> core_b = core(tables, b, rounding_b);
  const Turn turn_a(pose_a);
  const Turn turn_b(pose_b);
  const Integer scale = turn_a.square * turn_b.square;
  const auto position = [](const Pose& pose) {
    return vector_of(pose.position[0], pose.position[1], pose.position[2]);
  };
  const Vector offset = scale * (position(pose_b) - position(pose_a));
  std::set<Vector> distinct;
  for (const Vector& x : core_a) {
    for (const Vector& y : core_b) {
      distinct.insert(turn_b.square * turn_a(x) - turn_a.square * turn_b(y) - offset);
    }
  }
  const std::vector<Vector> w(distinct.begin(), distinct.end());
  if (origin_is_inside(w)) return ExactVerdict::overlapping;
  const Integer length = scale * (rounding_a + rounding_b);
  Nearest nearest(length * length);
  for (std::size_t i = 0; i < w.size(); ++i) {
    nearest.point(w[i]);
    for (std::size_t k = 0; k < i; ++k) {
      nearest.segment(w[i], w[k]);
      for (std::size_t m = 0; m < k; ++m) nearest.triangle(w[i], w[k], w[m]);
    }
  }
  return nearest.sign() > 0   ? ExactVerdict::separated
         : nearest.sign() < 0 ? ExactVerdict::overlapping
                              : ExactVerdict::touching;
}

}  // namespace winnow::test
