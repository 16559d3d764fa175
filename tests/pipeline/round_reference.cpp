// Reference implementation of signed distances of spheres, capsules, boxes, triangles and
// half-spaces in long double: closed forms and searches over all features. Used by the tests of
// round kernels.

#include "tests/pipeline/round_reference.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/numbers/rotation.h"

namespace winnow::test {
namespace {

using Real = long double;
constexpr Real kInf = std::numeric_limits<Real>::infinity();

Eigen::Matrix<Real, 3, 3> rotation_of(const Pose& pose) {
  const double* q = pose.orientation.data();
  return Eigen::Quaternion<Real>(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

void add_box(ReferenceShape& shape, const BoxShape& box) {
  for (int corner = 0; corner < 8; ++corner) {
    LongVector v;
    for (int i = 0; i < 3; ++i) v[i] = (corner >> i & 1) != 0 ? -box.half[i] : box.half[i];
    shape.vertices.push_back(v);
  }
  for (int i = 0; i < 3; ++i) {
    const int j = 1 << (i + 1) % 3;
    const int k = 1 << (i + 2) % 3;
    shape.normals.push_back(LongVector::Unit(i));
    for (const int base : {0, j, k, j | k}) {
      shape.edges.emplace_back(shape.vertices[static_cast<std::size_t>(base)],
                               shape.vertices[static_cast<std::size_t>(base | 1 << i)]);
    }
    for (const int base : {0, 1 << i}) {
      const auto at = [&](int corner) { return shape.vertices[static_cast<std::size_t>(corner)]; };
      shape.faces.push_back({at(base), at(base | j), at(base | j | k)});
      shape.faces.push_back({at(base), at(base | k), at(base | j | k)});
    }
  }
}

void add_triangle(ReferenceShape& shape, const TriangleShape& triangle) {
  for (const auto& v : triangle.vertex) shape.vertices.emplace_back(v[0], v[1], v[2]);
  const auto& v = shape.vertices;
  shape.faces.push_back({v[0], v[1], v[2]});
  for (std::size_t i = 0; i < 3; ++i) shape.edges.emplace_back(v[i], v[(i + 1) % 3]);
  const LongVector n = (v[1] - v[0]).cross(v[2] - v[0]);
  if (n.norm() > 0) shape.normals.push_back(n.normalized());
}

Real clamp01(Real t) {
  return std::isnan(t) ? 0 : std::clamp<Real>(t, 0, 1);
}

Real point_segment(const LongVector& p, const LongVector& a, const LongVector& b) {
  const LongVector e = b - a;
  return (a + e * clamp01(e.dot(p - a) / e.squaredNorm()) - p).norm();
}

Real point_triangle(const LongVector& p, const std::array<LongVector, 3>& t) {
  Real best = kInf;
  for (std::size_t i = 0; i < 3; ++i) {
    best = std::min(best, point_segment(p, t[i], t[(i + 1) % 3]));
  }
  const LongVector n = (t[1] - t[0]).cross(t[2] - t[0]);
  if (n.norm() == 0) return best;
  for (std::size_t i = 0; i < 3; ++i) {
    if (n.dot((t[(i + 1) % 3] - t[i]).cross(p - t[i])) < 0) return best;
  }
  return std::min(best, std::abs(n.normalized().dot(p - t[0])));
}

Real segment_segment(const LongVector& p0, const LongVector& p1, const LongVector& q0,
                     const LongVector& q1) {
  Real best = std::min({point_segment(p0, q0, q1), point_segment(p1, q0, q1),
                        point_segment(q0, p0, p1), point_segment(q1, p0, p1)});
  const LongVector d = p1 - p0;
  const LongVector e = q1 - q0;
  const LongVector k = d.cross(e);
  const Real kk = k.squaredNorm();
  if (kk == 0) return best;
  const Real s = k.dot((q0 - p0).cross(e)) / kk;
  const Real t = k.dot((q0 - p0).cross(d)) / kk;
  if (s < 0 || s > 1 || t < 0 || t > 1) return best;
  return std::min(best, (p0 + d * s - q0 - e * t).norm());
}

Real core_distance(const ReferenceShape& a, const ReferenceShape& b) {
  Real best = kInf;
  for (const auto& p : a.vertices) {
    for (const auto& q : b.vertices) best = std::min(best, (p - q).norm());
    for (const auto& e : b.edges) best = std::min(best, point_segment(p, e.first, e.second));
    for (const auto& f : b.faces) best = std::min(best, point_triangle(p, f));
  }
  for (const auto& e : a.edges) {
    for (const auto& q : b.vertices) best = std::min(best, point_segment(q, e.first, e.second));
    for (const auto& f : b.edges) {
      best = std::min(best, segment_segment(e.first, e.second, f.first, f.second));
    }
  }
  for (const auto& f : a.faces) {
    for (const auto& q : b.vertices) best = std::min(best, point_triangle(q, f));
  }
  return best;
}

Real core_overlap_along(const ReferenceShape& a, const ReferenceShape& b, const LongVector& n) {
  Real far_a = -kInf;
  Real near_b = kInf;
  for (const auto& v : a.vertices) far_a = std::max(far_a, n.dot(v));
  for (const auto& v : b.vertices) near_b = std::min(near_b, n.dot(v));
  return far_a - near_b;
}

// Returns the least overlap along the face normals of the Minkowski difference of the cores, if it
// has volume.
Real core_overlap(const ReferenceShape& a, const ReferenceShape& b) {
  std::vector<LongVector> axes = a.normals;
  axes.insert(axes.end(), b.normals.begin(), b.normals.end());
  // The edges of a box are parallel to its normals, including edges of length zero.
  std::vector<LongVector> directions;
  if (b.kind == ShapeKind::box) directions = b.normals;
  for (const auto& f : b.edges) {
    if (b.kind != ShapeKind::box) directions.push_back((f.second - f.first).normalized());
  }
  for (const auto& e : a.edges) {
    for (const LongVector& f : directions) {
      const LongVector k = (e.second - e.first).normalized().cross(f);
      if (k.norm() > 1e-9L) axes.push_back(k.normalized());
    }
  }
  Real least = kInf;
  for (const auto& n : axes) {
    least = std::min({least, core_overlap_along(a, b, n), core_overlap_along(a, b, -n)});
  }
  return least;
}

bool has_volume(const ReferenceShape& a, const ReferenceShape& b) {
  return b.kind == ShapeKind::box ||
         (a.kind == ShapeKind::capsule && b.kind == ShapeKind::triangle);
}

}  // namespace

ReferenceShape make_reference(const ShapeTables& tables, ShapeId id, const Pose& pose,
                              const double origin[3]) {
  ReferenceShape r;
  r.kind = id.kind();
  const std::uint32_t i = id.index();
  switch (r.kind) {
    case ShapeKind::sphere:
      r.rounding = tables.spheres[i].radius;
      r.vertices.emplace_back(0, 0, 0);
      break;
    case ShapeKind::capsule: {
      const LongVector end(0, 0, tables.capsules[i].half_length);
      r.rounding = tables.capsules[i].radius;
      r.vertices = {end, -end};
      r.edges.emplace_back(end, -end);
      break;
    }
    case ShapeKind::box:
      r.rounding = tables.boxes[i].rounding;
      add_box(r, tables.boxes[i]);
      break;
    case ShapeKind::triangle:
      r.rounding = tables.triangles[i].rounding;
      add_triangle(r, tables.triangles[i]);
      break;
    default: {
      const HalfSpaceShape& h = tables.half_spaces[i];
      r.normals.emplace_back(h.normal[0], h.normal[1], h.normal[2]);
      r.offset = h.offset / r.normals[0].norm();
      r.normals[0].normalize();
    }
  }
  const auto turn = rotation_of(pose);
  LongVector move;
  for (int k = 0; k < 3; ++k) move[k] = static_cast<Real>(pose.position[k]) - origin[k];
  const auto place = [&](LongVector& v) { v = (turn * v + move).eval(); };
  for (auto& v : r.vertices) place(v);
  for (auto& [p, q] : r.edges) place(p), place(q);
  for (auto& f : r.faces) {
    for (auto& v : f) place(v);
  }
  for (auto& n : r.normals) n = (turn * n).eval();
  if (r.kind == ShapeKind::half_space) {
    r.reach = std::abs(r.offset) + move.norm();
    r.offset += r.normals[0].dot(move);
  }
  return r;
}

long double reference_distance(const ReferenceShape& a, const ReferenceShape& b) {
  if (b.kind == ShapeKind::half_space) return -reference_overlap_along(a, b, -b.normals[0]);
  const Real rounding = a.rounding + b.rounding;
  if (has_volume(a, b)) {
    const Real depth = core_overlap(a, b);
    if (depth < kInf && depth > 1e-17L * reference_scale(a, b)) return -depth - rounding;
  }
  return core_distance(a, b) - rounding;
}

long double reference_overlap_along(const ReferenceShape& a, const ReferenceShape& b,
                                    const LongVector& n) {
  if (b.kind != ShapeKind::half_space) {
    return core_overlap_along(a, b, n) + a.rounding + b.rounding;
  }
  Real low = kInf;
  for (const auto& v : a.vertices) low = std::min(low, b.normals[0].dot(v));
  return b.offset - low + a.rounding;
}

long double reference_distance(const ReferenceShape& shape, const LongVector& point) {
  if (shape.kind == ShapeKind::half_space) {
    return std::max<Real>(0, shape.normals[0].dot(point) - shape.offset);
  }
  ReferenceShape p;
  p.vertices.push_back(point);
  if (shape.kind == ShapeKind::box && core_overlap(p, shape) > 0) return 0;
  return std::max<Real>(0, core_distance(p, shape) - shape.rounding);
}

long double reference_scale(const ReferenceShape& a, const ReferenceShape& b) {
  Real r = a.rounding + b.rounding + b.reach;
  for (const ReferenceShape* s : {&a, &b}) {
    Real reach = 0;
    for (const auto& v : s->vertices) reach = std::max(reach, v.norm());
    r += reach;
  }
  return r;
}

}  // namespace winnow::test
