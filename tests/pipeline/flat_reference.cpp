#include "tests/pipeline/flat_reference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow::test {

namespace {

using LongMatrix = Eigen::Matrix<long double, 3, 3>;

LongMatrix rotation(const Pose& pose) {
  const double* q = pose.orientation.data();
  return Eigen::Quaternion<long double>(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

LongVector offset(const Pose& pose, const double origin[3]) {
  return {static_cast<long double>(pose.position[0]) - origin[0],
          static_cast<long double>(pose.position[1]) - origin[1],
          static_cast<long double>(pose.position[2]) - origin[2]};
}

struct Search {
  const FlatReference& a;
  const FlatReference& b;
  long double best = -std::numeric_limits<long double>::infinity();

  void test_axis(const LongVector& axis) {
    const long double size =
        std::max({std::fabs(axis.x()), std::fabs(axis.y()), std::fabs(axis.z())});
    if (!(size > 0.0L)) return;
    best = std::max({best, separation(a, b, axis), separation(a, b, -axis)});
  }
};

// Returns the part of v perpendicular to e, or zero if it is only rounding.
LongVector across(const LongVector& v, const LongVector& e) {
  if (!(e.norm() > 0.0L) || !(v.norm() > 0.0L)) return v;
  const LongVector u = e.normalized();
  const LongVector w = v - u * u.dot(v);
  return w.norm() > 1e-15L * v.norm() ? LongVector(w - u * u.dot(w)) : LongVector::Zero();
}

// Returns the cross product, or zero if the vectors are parallel up to rounding.
LongVector product(const LongVector& e, const LongVector& f) {
  const LongVector n = e.cross(f);
  return n.norm() > 1e-17L * e.norm() * f.norm() ? n : LongVector::Zero();
}

}  // namespace

FlatReference::FlatReference(const BoxShape& box, const Pose& pose, const double origin[3])
    : rounding(box.rounding) {
  const LongMatrix turn = rotation(pose);
  const LongVector center = offset(pose, origin);
  for (int i = 0; i < 8; ++i) {
    const LongVector corner((i & 1) != 0 ? box.half[0] : -box.half[0],
                            (i & 2) != 0 ? box.half[1] : -box.half[1],
                            (i & 4) != 0 ? box.half[2] : -box.half[2]);
    vertices.emplace_back(center + turn * corner);
  }
  for (int i = 0; i < 3; ++i) {
    edges.emplace_back(turn.col(i));
    normals.emplace_back(turn.col(i));
  }
}

FlatReference::FlatReference(const TriangleShape& triangle, const Pose& pose,
                             const double origin[3])
    : rounding(triangle.rounding) {
  const LongMatrix turn = rotation(pose);
  const LongVector center = offset(pose, origin);
  for (const auto& v : triangle.vertex) {
    vertices.emplace_back(center + turn * LongVector(v[0], v[1], v[2]));
  }
  for (std::size_t i = 0; i < 3; ++i) edges.emplace_back(vertices[(i + 1) % 3] - vertices[i]);
  const LongVector normal = product(edges[0], edges[1]);
  normals.push_back(normal);
  for (std::size_t i = 0; i < 3; ++i) normals.emplace_back(normal.cross(edges[i]));
}

long double separation(const FlatReference& a, const FlatReference& b, const LongVector& axis) {
  const LongVector n = axis.stableNormalized();
  long double top = -std::numeric_limits<long double>::infinity();
  long double bottom = std::numeric_limits<long double>::infinity();
  for (const LongVector& v : a.vertices) top = std::max(top, n.dot(v));
  for (const LongVector& v : b.vertices) bottom = std::min(bottom, n.dot(v));
  return bottom - top - a.rounding - b.rounding;
}

long double signed_distance(const FlatReference& a, const FlatReference& b) {
  Search search{a, b};
  for (const LongVector& n : a.normals) search.test_axis(n);
  for (const LongVector& n : b.normals) search.test_axis(n);
  for (const LongVector& e : a.edges) {
    for (const LongVector& f : b.edges) search.test_axis(product(e, f));
  }
  // Directions from a vertex can be best only if the shapes are apart.
  for (const LongVector& v : a.vertices) {
    for (const LongVector& w : b.vertices) {
      const LongVector d = w - v;
      search.test_axis(d);
      for (const LongVector& e : a.edges) search.test_axis(across(d, e));
      for (const LongVector& f : b.edges) search.test_axis(across(d, f));
    }
  }
  return search.best;
}

}  // namespace winnow::test
