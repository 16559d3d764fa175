// Candidate axes for core_distance.cpp: from a GJK simplex, from face normals and edge products
// (SAT), and from the symmetry of cores of revolution.

#include "pipeline/solver/axis_search.h"

#include <cmath>

namespace winnow::solver {
namespace {

/// The longest difference of up to four points, and the difference that spans the largest area with
/// it.
struct Span {
  Vec first = Vec::Zero();
  Vec second = Vec::Zero();
  double length = 0.0;
  double area = 0.0;

  void offer(const Vec& d) noexcept {
    if (d.squaredNorm() > length) {
      length = d.squaredNorm();
      first = d;
    }
  }
  void offer_second(const Vec& d) noexcept {
    const double square = unit(d).cross(first).squaredNorm();
    if (square > area) {
      area = square;
      second = unit(d);
    }
  }
};

template <typename Body>
void for_differences(const GjkSimplex& simplex, Body&& body) {
  for (std::size_t i = 1; i < static_cast<std::size_t>(simplex.count); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      body(Vec(simplex.point[i].a - simplex.point[k].a));
      body(Vec(simplex.point[i].b - simplex.point[k].b));
    }
  }
}

void test_products(const Core& a, const Core& b, AxisSearch& search) noexcept {
  for (std::uint32_t i = 0; i < direction_count(a); ++i) {
    const Vec e = unit(direction(a, i));
    for (std::uint32_t k = 0; k < direction_count(b); ++k) {
      search.test_axis(perpendicular(e, unit(direction(b, k))));
    }
  }
}

/// The normals of an edge's two faces, in world axes: an arc of the Gauss map.
struct Arc {
  Vec direction;
  Vec normal[2];
  Vec point;
};

Arc arc(const Core& core, std::uint32_t i) noexcept {
  const HullEdge& e = core.hull->edges[i];
  return {direction(core, i),
          {face_normal(core, e.face[0]), face_normal(core, e.face[1])},
          vertex(core, e.vertex[0])};
}

/// Returns false only if the arc of a and the reversed arc of b certainly do not cross on the Gauss
/// map; the edges then make no face of the Minkowski difference.
bool may_cross(const Arc& a, const Arc& b) noexcept {
  constexpr double kCrossTolerance = 1e-9;
  const double b0 = -b.normal[0].dot(a.direction);
  const double b1 = -b.normal[1].dot(a.direction);
  const double a0 = a.normal[0].dot(b.direction);
  const double a1 = a.normal[1].dot(b.direction);
  return b0 * b1 <= kCrossTolerance && a0 * a1 <= kCrossTolerance;
}

void test_hull_products(const Problem& problem, AxisSearch& search) noexcept {
  const Core& a = problem.a;
  const Core& b = problem.b;
  for (std::uint32_t i = 0; i < edge_count(a); ++i) {
    const Arc of_a = arc(a, i);
    for (std::uint32_t k = 0; k < edge_count(b); ++k) {
      const Arc of_b = arc(b, k);
      if (!may_cross(of_a, of_b)) continue;
      const Vec n = perpendicular(of_a.direction, of_b.direction);
      // If the axis is the normal of a face that the two edges make, its separation is the distance
      // of the edges along it; projecting all vertices is needed only if that may beat the best so
      // far.
      const double outward = n.dot(of_a.normal[0] + of_a.normal[1]);
      const double between = n.dot(of_b.point - of_a.point) * (outward < 0.0 ? -1.0 : 1.0);
      const bool sure = std::abs(outward) > 1e-6;
      if (sure && between < search.separation() - problem.noise()) continue;
      search.test_axis(n);
    }
  }
}

bool is_solid_hull(const Core& core) noexcept {
  return core.kind == ShapeKind::hull && core.hull->dimension == 3;
}

}  // namespace

void AxisSearch::test_axis(const Vec& axis) noexcept {
  if (axis == Vec::Zero()) return;
  const double offset = axis.dot(b_.center - a_.center);
  const AxisRange a = project(a_, axis);
  const AxisRange b = project(b_, axis);
  const double forward = offset + b.low - a.high;
  const double backward = a.low - b.high - offset;
  if (forward > separation_) {
    separation_ = forward;
    axis_ = axis;
  }
  if (backward > separation_) {
    separation_ = backward;
    axis_ = -axis;
  }
}

void test_simplex(const GjkResult& found, AxisSearch& search) noexcept {
  Span span;
  for_differences(found.simplex, [&](const Vec& d) { span.offer(d); });
  if (span.length == 0.0) return;
  span.first = unit(span.first);
  for_differences(found.simplex, [&](const Vec& d) { span.offer_second(d); });
  search.test_axis(without(found.between, span.first));
  if (span.area > 0.0) search.test_axis(perpendicular(span.first, span.second));
}

void test_normals(const Problem& problem, AxisSearch& search) noexcept {
  for (const Core* core : {&problem.a, &problem.b}) {
    for (std::uint32_t i = 0; i < normal_count(*core); ++i) search.test_axis(normal(*core, i));
  }
}

bool test_features(const Problem& problem, AxisSearch& search) noexcept {
  const Core& a = problem.a;
  const Core& b = problem.b;
  test_normals(problem, search);
  const std::uint64_t products = std::uint64_t{direction_count(a)} * direction_count(b);
  if (products > kMaxFeaturePairs) return false;
  if (is_solid_hull(a) && is_solid_hull(b)) {
    test_hull_products(problem, search);
  } else {
    test_products(a, b, search);
  }
  return true;
}

namespace {

bool is_round(const Core& core) noexcept {
  return core.kind == ShapeKind::sphere || core.kind == ShapeKind::capsule ||
         core.kind == ShapeKind::cylinder || core.kind == ShapeKind::cone;
}

/// Tests the two normals of a cone's side in the plane of its axis and `across`.
void test_side(const Core& core, const Vec& across, AxisSearch& search) noexcept {
  if (core.kind != ShapeKind::cone) return;
  const Vec out = across * (2.0 * core.half.z());
  const Vec up = core.rotation.col(2) * core.half.x();
  search.test_axis(unit(out + up));
  search.test_axis(unit(out - up));
}

}  // namespace

double sine_between_axes(const Problem& problem) noexcept {
  const Core& a = problem.a;
  const Core& b = problem.b;
  if (!is_round(a) || !is_round(b)) return std::numeric_limits<double>::infinity();
  if (a.kind == ShapeKind::sphere || b.kind == ShapeKind::sphere) return 0.0;
  return a.rotation.col(2).cross(b.rotation.col(2)).norm();
}

void test_revolution(const Problem& problem, AxisSearch& search) noexcept {
  const Core& a = problem.a;
  const Core& b = problem.b;
  const Core& first = a.kind != ShapeKind::sphere ? a : b;
  const Vec axis = first.rotation.col(2);
  Vec across = without(b.center - a.center, axis);
  // If the centers lie on the axis, every direction across is equally good: take the first tie
  // axis.
  const Vec aside = (b.center - a.center) - axis * axis.dot(b.center - a.center);
  for (int i = 0; i < 3 && aside.norm() <= kEpsilon * problem.size; ++i) {
    across = without(problem.tie_axes.col(i), axis);
    if (across != Vec::Zero()) break;
  }
  search.test_axis(axis);
  search.test_axis(across);
  test_side(a, across, search);
  test_side(b, across, search);
}

}  // namespace winnow::solver
