#include "tests/pipeline/hull_brute_force.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace winnow::test {
namespace {

using Vector = Eigen::Matrix<long double, 3, 1>;
using Matrix = Eigen::Matrix<long double, 3, 3>;

Matrix rotation(const Pose& pose) {
  const double* q = pose.orientation.data();
  Eigen::Quaternion<long double> r(q[0], q[1], q[2], q[3]);
  return r.normalized().toRotationMatrix();
}

/// A hull in world axes, relative to a point.
struct Placed {
  Placed(const HullShape& shape, const Pose& pose, const Pose& origin) : hull(shape) {
    const Matrix turn = rotation(pose);
    Vector shift;
    for (int k = 0; k < 3; ++k) {
      shift[k] = static_cast<long double>(pose.position[k]) - origin.position[k];
    }
    for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
      vertex.push_back(turn * Vector(shape.vertex[0][i], shape.vertex[1][i], shape.vertex[2][i]) +
                       shift);
    }
    // Recomputed from the corners: stored normals are rounded.
    for (std::uint32_t f = 0; f < shape.face_count; ++f) {
      Vector n = Vector::Zero();
      const Vector& c = corner(f, 0);
      for (std::uint32_t i = 1; i + 1 < shape.faces[f].count; ++i) {
        n += (corner(f, i) - c).cross(corner(f, i + 1) - c);
      }
      normal.push_back(n.normalized());
    }
  }
  [[nodiscard]] const Vector& corner(std::uint32_t face, std::uint32_t i) const {
    return vertex[hull.loop[hull.faces[face].first + i % hull.faces[face].count]];
  }
  [[nodiscard]] const Vector& end(std::uint32_t edge, int i) const {
    return vertex[hull.edges[edge].vertex[i]];
  }

  const HullShape& hull;
  std::vector<Vector> vertex;
  std::vector<Vector> normal;
};

long double overlap_along(const Placed& a, const Placed& b, const Vector& n) {
  long double high = -std::numeric_limits<long double>::infinity();
  long double low = -high;
  for (const Vector& x : a.vertex) high = std::max(high, n.dot(x));
  for (const Vector& x : b.vertex) low = std::min(low, n.dot(x));
  return high - low;
}

long double depth(const Placed& a, const Placed& b) {
  long double least = std::numeric_limits<long double>::infinity();
  for (const Vector& n : a.normal) least = std::min(least, overlap_along(a, b, n));
  for (const Vector& n : b.normal) least = std::min(least, overlap_along(a, b, -n));
  for (std::uint32_t e = 0; e < a.hull.edge_count; ++e) {
    const Vector d = (a.end(e, 1) - a.end(e, 0)).normalized();
    for (std::uint32_t f = 0; f < b.hull.edge_count; ++f) {
      const Vector n = d.cross((b.end(f, 1) - b.end(f, 0)).normalized());
      // Parallel edges span no face of the Minkowski difference. If edges are nearly parallel, a
      // face normal is close to their cross product.
      if (n.norm() < 1e-9L) continue;
      least = std::min(least, overlap_along(a, b, n.normalized()));
      least = std::min(least, overlap_along(a, b, -n.normalized()));
    }
  }
  return least;
}

long double edge_to_edge(const Vector& p, const Vector& q, const Vector& r, const Vector& s) {
  const auto to_segment = [](const Vector& x, const Vector& u, const Vector& v) {
    const Vector d = v - u;
    const long double t = std::clamp(d.dot(x - u) / d.squaredNorm(), 0.0L, 1.0L);
    return (u + t * d - x).norm();
  };
  long double least = std::min(
      {to_segment(p, r, s), to_segment(q, r, s), to_segment(r, p, q), to_segment(s, p, q)});
  const Vector d = q - p;
  const Vector e = s - r;
  const Vector n = d.cross(e);
  const long double square = n.squaredNorm();
  if (square < 1e-18L * d.squaredNorm() * e.squaredNorm()) return least;
  const long double t = (r - p).cross(e).dot(n) / square;
  const long double u = (r - p).cross(d).dot(n) / square;
  if (t < 0 || t > 1 || u < 0 || u > 1) return least;
  return std::min(least, (p + t * d - r - u * e).norm());
}

long double corners_to_faces(const Placed& a, const Placed& b) {
  long double least = std::numeric_limits<long double>::infinity();
  for (std::uint32_t f = 0; f < b.hull.face_count; ++f) {
    for (const Vector& x : a.vertex) {
      const long double height = b.normal[f].dot(x - b.corner(f, 0));
      if (height < 0) continue;
      bool inside = true;
      for (std::uint32_t i = 0; i < b.hull.faces[f].count; ++i) {
        const Vector side = b.corner(f, i + 1) - b.corner(f, i);
        inside = inside && b.normal[f].cross(side).dot(x - b.corner(f, i)) >= 0;
      }
      if (inside) least = std::min(least, height);
    }
  }
  return least;
}

long double gap(const Placed& a, const Placed& b) {
  long double least = std::min(corners_to_faces(a, b), corners_to_faces(b, a));
  for (std::uint32_t e = 0; e < a.hull.edge_count; ++e) {
    for (std::uint32_t f = 0; f < b.hull.edge_count; ++f) {
      least = std::min(least, edge_to_edge(a.end(e, 0), a.end(e, 1), b.end(f, 0), b.end(f, 1)));
    }
  }
  return least;
}

}  // namespace

long double brute_force_distance(const HullShape& a, const Pose& pose_a, const HullShape& b,
                                 const Pose& pose_b) {
  const Placed first(a, pose_a, pose_a);
  const Placed second(b, pose_b, pose_a);
  const long double overlap = depth(first, second);
  return overlap >= 0 ? -overlap : gap(first, second);
}

}  // namespace winnow::test
