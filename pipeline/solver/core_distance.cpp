// The distance of two cores in three steps: GJK; if its bounds do not close, SAT axes and
// brute-force feature tests; if the cores overlap, the penetration depth by SAT, by symmetry or by
// an expanding polytope (EPA). Called by solver.cpp.

#include "pipeline/solver/core_distance.h"

#include "pipeline/solver/axis_search.h"
#include "pipeline/solver/expanding_polytope.h"
#include "pipeline/solver/gjk.h"
#include "pipeline/solver/point_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace winnow::solver {
namespace {

/// A point of each core and the squared distance between them.
struct ClosestPoints {
  Vec on_a = Vec::Zero();
  Vec on_b = Vec::Zero();
  double square = std::numeric_limits<double>::infinity();
};

/// The part of a polytope that contains the closest point: axis . x >= `from`.
struct Slab {
  const Core& core;
  Vec axis;
  double from;

  [[nodiscard]] bool has(std::uint32_t i) const noexcept {
    return axis.dot(vertex(core, i)) >= from;
  }
};

void offer(const Vec& on_a, const Vec& on_b, ClosestPoints& best) noexcept {
  const double square = (on_b - on_a).squaredNorm();
  if (square < best.square) best = {on_a, on_b, square};
}

/// Returns the point of the segment p + [0, 1] e that is nearest to x.
Vec on_segment(const Vec& p, const Vec& e, const Vec& x) noexcept {
  const double square = e.squaredNorm();
  if (!(square > 0.0)) return p;
  return p + e * std::clamp(e.dot(x - p) / square, 0.0, 1.0);
}

/// Tests each end of a segment against the other segment, and the interiors against each other. The
/// interior test uses only components perpendicular to e, the longer segment: that stays right to
/// rounding at small angles, where the usual determinant loses twice as many digits.
void edge_edge(const Vec& p, const Vec& e, const Vec& q, const Vec& f, bool flip,
               ClosestPoints& best) noexcept {
  const auto put = [&](const Vec& x, const Vec& y) {
    flip ? offer(y, x, best) : offer(x, y, best);
  };
  put(p, on_segment(q, f, p));
  put(p + e, on_segment(q, f, p + e));
  put(on_segment(p, e, q), q);
  put(on_segment(p, e, q + f), q + f);
  const Vec u = unit(e);
  const Vec across = f - u * u.dot(f);
  const double square = across.squaredNorm();
  if (!(square > 0.0)) return;
  const Vec between = p - q;
  const double t = across.dot(between - u * u.dot(between)) / square;
  if (!(t > 0.0 && t < 1.0)) return;
  const Vec y = q + f * t;
  put(on_segment(p, e, y), y);
}

bool edges(const Slab& a, const Slab& b, ClosestPoints& best) noexcept {
  // A point counts as an edge of length zero.
  const std::uint32_t count_a = std::max(edge_count(a.core), 1U);
  const std::uint32_t count_b = std::max(edge_count(b.core), 1U);
  std::uint64_t pairs = 0;
  const auto ends = [](const Core& core, std::uint32_t i) {
    return edge_count(core) == 0 ? std::array<std::uint32_t, 2>{0, 0} : edge(core, i);
  };
  for (std::uint32_t i = 0; i < count_a; ++i) {
    const auto [a0, a1] = ends(a.core, i);
    if (!a.has(a0) && !a.has(a1)) continue;
    const Vec p = vertex(a.core, a0);
    const Vec e = vertex(a.core, a1) - p;
    pairs += count_b;
    if (pairs > kMaxFeaturePairs) return false;
    for (std::uint32_t k = 0; k < count_b; ++k) {
      const auto [b0, b1] = ends(b.core, k);
      if (!b.has(b0) && !b.has(b1)) continue;
      const Vec q = vertex(b.core, b0);
      const Vec f = vertex(b.core, b1) - q;
      if (e.squaredNorm() >= f.squaredNorm()) {
        edge_edge(p, e, q, f, false, best);
      } else {
        edge_edge(q, f, p, e, true, best);
      }
    }
  }
  return true;
}

/// True if x is certainly above the interior of a face. All other points are at least as near to an
/// edge. Faces without area have no interior.
bool above_face(const Core& core, std::uint32_t face, const Vec& n, const Vec& x) noexcept {
  const std::uint32_t count = face_size(core, face);
  Vec p = vertex(core, face_vertex(core, face, count - 1));
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec q = vertex(core, face_vertex(core, face, i));
    const Vec side = q - p;
    const Vec to = x - p;
    const double doubt = 8.0 * kEpsilon * std::sqrt(side.squaredNorm() * to.squaredNorm());
    if (!(n.dot(side.cross(to)) > doubt)) return false;
    p = q;
  }
  return true;
}

bool corners_faces(const Slab& corners, const Slab& faces, bool flip,
                   ClosestPoints& best) noexcept {
  std::uint64_t pairs = 0;
  for (std::uint32_t i = 0; i < vertex_count(corners.core); ++i) {
    if (!corners.has(i)) continue;
    const Vec x = vertex(corners.core, i);
    pairs += face_count(faces.core);
    if (pairs > kMaxFeaturePairs) return false;
    for (std::uint32_t face = 0; face < face_count(faces.core); ++face) {
      const Vec n = face_normal(faces.core, face);
      const double height = n.dot(x - vertex(faces.core, face_vertex(faces.core, face, 0)));
      if (height * height >= best.square || !above_face(faces.core, face, n, x)) continue;
      const Vec foot = x - n * height;
      flip ? offer(foot, x, best) : offer(x, foot, best);
    }
  }
  return true;
}

/// Finds the closest points of two separate polytopes by testing corners against faces and edges
/// against edges. The cores are at least `lower` apart along the unit axis from a to b, and at most
/// `upper` apart: only features that reach into the two slabs that can contain the closest points
/// are tested. O(features of a x features of b in the slabs); returns false if that is above
/// kMaxFeaturePairs.
///
/// Proof of the slabs: along the axis, b begins at least `lower` behind the last point of a. A
/// point of a that is farther than upper - lower before that last point is more than `upper` from
/// b, and is not the closest; likewise for b.
bool closest_features(const Core& a, const Core& b, const Vec& axis, double lower, double upper,
                      double noise, ClosestPoints& points) noexcept {
  const double depth = upper - lower + noise;
  const Slab of_a{a, axis, axis.dot(a.center) + project(a, axis).high - depth};
  const Slab of_b{b, -axis, -axis.dot(b.center) - project(b, axis).low - depth};
  return corners_faces(of_a, of_b, false, points) && corners_faces(of_b, of_a, true, points) &&
         edges(of_a, of_b, points);
}

/// Up to this many edge products, all axes are tested instead of expanding a polytope.
constexpr std::uint32_t kFewProducts = 40;
/// Axes of cylinders and cones count as parallel if the sine of their angle is at most this.
constexpr double kParallel = 8.0 * kEpsilon;
/// Tolerance of the depth of cylinders and cones, relative to the sizes.
constexpr double kSmoothTolerance = 1e-11;

CoreDistance half_space_distance(const Problem& problem) noexcept {
  const Core& a = problem.a;
  const Core& b = problem.b;
  CoreDistance found;
  found.doubt = problem.noise();
  if (a.kind == ShapeKind::half_space) {
    found.axis = a.normal;
    found.on_a = a.normal * a.offset;
    if ((a.normal + b.normal).cwiseAbs().maxCoeff() <= 4.0 * kEpsilon) {
      found.distance = a.normal.dot(b.center) - b.offset - a.offset;
    } else {
      // No translation separates them.
      found.distance = -std::numeric_limits<double>::max();
      found.doubt = std::numeric_limits<double>::infinity();
    }
    return found;
  }
  found.axis = -b.normal;
  found.distance = -b.normal.dot(b.center) - b.offset + project(a, b.normal).low;
  found.on_a = support(a, found.axis);
  return found;
}

/// Tests axes perpendicular to the line of a pair of points, segments, triangles and hulls without
/// area, which may all be on one line.
void test_across_line(const Problem& problem, AxisSearch& search) noexcept {
  Vec line = Vec::Zero();
  for (const Core* core : {&problem.a, &problem.b}) {
    const bool is_line = core->hull != nullptr ? core->hull->dimension < 2
                                               : is_polytope(*core) && face_count(*core) < 2;
    if (!is_line) return;
    for (std::uint32_t i = 0; i < direction_count(*core) && line == Vec::Zero(); ++i) {
      line = unit(direction(*core, i));
    }
  }
  // Two points have no line: every axis is perpendicular to it.
  for (int i = 0; i < 3; ++i) search.test_axis(without(problem.tie_axes.col(i), line));
}

/// Replaces the axis by the first of +x, -x, +y, -y, +z, -z of the caller's frame that separates as
/// well as the best, if there is one.
void break_ties(const Problem& problem, double separated, Vec& axis) noexcept {
  for (int i = 0; i < 6; ++i) {
    const Vec candidate = problem.tie_axes.col(i / 2) * (i % 2 == 0 ? 1.0 : -1.0);
    const double along = separation(problem.a, problem.b, candidate);
    if (along < separated - kTieTolerance * problem.noise()) continue;
    axis = candidate;
    return;
  }
}

/// GJK converges slowly if curved cores nearly touch. Along a good axis the closest parts of
/// cylinders and cones are straight lines, so that GJK on their meridian triangles ends at once.
void refine_curved(const Core& a, const Core& b, const Vec& axis, double noise,
                   GjkResult& found) noexcept {
  const Core straight_a = meridian(a, axis);
  const Core straight_b = meridian(b, -axis);
  for (const auto& [x, y] :
       {std::pair{&straight_a, &straight_b}, {&straight_a, &b}, {&a, &straight_b}}) {
    const GjkResult straight = gjk(*x, *y, axis, {.noise = kConvergence * noise});
    if (!straight.contact && !(straight.upper < found.upper)) continue;
    found.simplex = straight.simplex;
    found.between = straight.between;
    found.upper = straight.upper;
    found.contact = straight.contact;
    if (found.contact) return;
  }
}

/// The distance of a point from the other core, along the best axis.
CoreDistance distance_along(const Problem& problem, const Vec& axis) noexcept {
  CoreDistance found;
  found.axis = axis;
  found.distance = separation(problem.a, problem.b, axis);
  found.doubt = problem.noise();
  found.on_a = problem.a.center;
  if (found.distance <= 0.0) break_ties(problem, found.distance, found.axis);
  return found;
}

/// Returns a point that is on both cores once b has been moved by `depth` along the axis.
Vec contact_point(const Problem& problem, const Vec& axis, double depth) noexcept {
  const Core& a = problem.a;
  const double noise = problem.noise();
  Core moved = problem.b;
  moved.center += axis * depth;
  GjkResult gjk_result = gjk(a, moved, axis, {.noise = kConvergence * noise});
  Vec x = gjk_result.simplex.on_a();
  // If the simplex is a flat tetrahedron, the origin is inside, but its weights are inaccurate.
  gjk_result.upper = gjk_result.simplex.closest().norm();
  if (gjk_result.upper > kTieTolerance * noise && is_polytope(a) && is_polytope(moved)) {
    ClosestPoints points;
    if (closest_features(a, moved, axis, 0.0, gjk_result.upper, noise, points)) x = points.on_a;
  } else if (gjk_result.upper > kTieTolerance * noise) {
    refine_curved(a, moved, axis, noise, gjk_result);
    x = gjk_result.simplex.on_a();
  }
  return x + axis * (project(a, axis).high - axis.dot(x - a.center));
}

/// The distance of separate cores. It is between the separation along the best axis, which proves
/// that they are at least so far apart, and the length of `between`, which joins two of their
/// points. If these bounds of polytopes differ by more than rounding, the features decide.
CoreDistance distance_apart(const Problem& problem, const GjkResult& start,
                            const AxisSearch& search, SolverCounts& counts) noexcept {
  CoreDistance found;
  const double noise = problem.noise();
  double upper = start.upper;
  Vec between = start.between;
  found.on_a = start.simplex.on_a();
  double gap = upper - search.separation();
  const bool polytopes = is_polytope(problem.a) && is_polytope(problem.b);
  if (gap > kTieTolerance * noise && polytopes) {
    ++counts.bounded;
    ClosestPoints points;
    if (closest_features(problem.a, problem.b, search.axis(), search.separation(), upper, noise,
                         points)) {
      gap = 0.0;
      between = points.on_b - points.on_a;
      upper = between.norm();
      found.on_a = points.on_a;
    }
  }
  found.distance = upper;
  found.doubt = noise + std::max(gap, 0.0);
  // A short vector between the closest points has no accurate direction; if it is long, no axis is
  // better.
  const bool is_long = upper > 1e-4 * problem.size;
  found.axis = is_long || search.axis() == Vec::Zero() ? unit(between) : search.axis();
  if (found.axis == Vec::Zero()) found.axis = problem.tie_axes.col(0);
  return found;
}

/// Returns a segment or disc whose rounded body lies inside the cylinder, with the largest rounding
/// that fits. Other cores are returned with rounding 0.
Core inscribed(const Core& core) noexcept {
  Core inner = core;
  inner.rounding = 0.0;
  inner.rounding = inscribe(inner);
  return inner;
}

/// Returns a lower bound of the depth: the depth of the bodies inscribed in both cores. A
/// translation that separates the cores also separates these, as they are parts of the cores; their
/// own depth is at least the sum of their roundings less the distance of their cores.
double inscribed_depth(const Problem& problem) noexcept {
  const Core a = inscribed(problem.a);
  const Core b = inscribed(problem.b);
  const Vec start = b.center == Vec::Zero() ? Vec(problem.tie_axes.col(0)) : b.center;
  const GjkResult gjk_result = gjk(a, b, start, {.noise = kConvergence * problem.noise()});
  return a.rounding + b.rounding - (gjk_result.contact ? 0.0 : gjk_result.upper);
}

/// For cores of revolution for which the expanding polytope has not converged, because many
/// directions are nearly equally good. Returns by how much the depth along the best axis may exceed
/// the true depth: bounded by the bodies inscribed in the cores and, if their axes are nearly
/// parallel, by test_revolution.
double gap_of_round(const Problem& problem, double turn, double gap, AxisSearch& search) noexcept {
  constexpr double kNearlyParallel = 1e-6;
  const double depth = -search.separation();
  if (turn <= kNearlyParallel) {
    test_revolution(problem, search);
    gap = std::min(gap - depth - search.separation(), 2.0 * turn * problem.b.half.norm());
  }
  return std::min(gap, -search.separation() - inscribed_depth(problem));
}

/// Tests the axis that expand_polytope returns, and the features if its bounds do not close.
/// Returns by how much the depth along the best axis may exceed the true depth.
double test_by_expansion(const Problem& problem, const GjkResult& start, double turn,
                         AxisSearch& search, SolverCounts& counts) noexcept {
  const double noise = problem.noise();
  const bool polytopes = is_polytope(problem.a) && is_polytope(problem.b);
  const double tolerance = polytopes ? noise : kSmoothTolerance * problem.size;
  const DepthBounds bounds = expand_polytope(problem.a, problem.b, start.simplex, noise, tolerance);
  search.test_axis(bounds.axis);
  double gap = -search.separation() - bounds.lower;
  if (polytopes && !(gap > 4.0 * noise)) return gap;
  if (polytopes) ++counts.bounded;
  const bool all = test_features(problem, search);
  test_across_line(problem, search);
  gap = polytopes && all ? 0.0 : -search.separation() - bounds.lower;
  if (polytopes || !(gap > 2.0 * tolerance)) return gap;
  if (std::isfinite(turn)) gap = gap_of_round(problem, turn, gap, search);
  if (gap > 2.0 * tolerance) ++counts.bounded;
  return gap;
}

/// For cores that overlap or touch: tests their face normals, if there are few. Returns true if the
/// cores overlap by no more than rounding along one of them; no other axis is better then.
bool touch_along_normal(const Problem& problem, AxisSearch& search) noexcept {
  if (normal_count(problem.a) + normal_count(problem.b) > kFewProducts) return false;
  test_normals(problem, search);
  return search.separation() >= -kTieTolerance * problem.noise();
}

/// The depth along the best axis, or the distance if that axis separates the cores. The depth along
/// any axis is an upper bound of the least depth; `gap` is by how much it may exceed that. It is 0
/// after tests of axes that include one of least depth: the face normals and edge products of
/// polytopes, and the normals of a body of revolution.
CoreDistance penetration(const Problem& problem, const GjkResult& start, ContactLevel level,
                         SolverCounts& counts) noexcept {
  const Core& a = problem.a;
  const Core& b = problem.b;
  const double noise = problem.noise();
  const bool polytopes = is_polytope(a) && is_polytope(b);
  AxisSearch search(a, b);
  double gap = 0.0;
  const double turn = sine_between_axes(problem);
  const bool few = std::uint64_t{direction_count(a)} * direction_count(b) <= kFewProducts &&
                   normal_count(a) + normal_count(b) <= kFewProducts;
  if (touch_along_normal(problem, search)) {
    gap = 0.0;
  } else if (polytopes && few) {
    test_features(problem, search);
    test_across_line(problem, search);
  } else if (turn <= kParallel) {
    test_revolution(problem, search);
  } else {
    gap = test_by_expansion(problem, start, turn, search, counts);
  }
  CoreDistance found;
  found.axis = search.axis();
  found.distance = search.separation();
  break_ties(problem, found.distance, found.axis);
  found.doubt = noise + std::max(gap, 0.0);
  if (level != ContactLevel::boolean) {
    found.on_a = contact_point(problem, found.axis, -found.distance);
  }
  return found;
}

/// True if the roundings or the simplex of GJK prove that the shapes overlap: the cores are nearer
/// than the sum of their roundings; or the origin lies in a tetrahedron of points of b - a, farther
/// from each face than rounding can move that face, so that b - a contains the origin and the cores
/// share a point.
bool surely_overlap(const Problem& problem, const GjkResult& start) noexcept {
  const double roundings = problem.a.rounding + problem.b.rounding;
  const double noise = problem.noise();
  if (start.upper + noise < roundings) return true;
  if (!start.simplex.inside) return false;
  const auto& point = start.simplex.point;
  for (const auto& [i, j, k] : kTetrahedronFace) {
    const Vec e = point[j].w - point[i].w;
    const Vec f = point[k].w - point[i].w;
    const Vec n = perpendicular(unit(e), unit(f));
    // Slivers have no accurate normal.
    if (unit(e).cross(unit(f)).squaredNorm() < 1e-4) return false;
    if (!(std::abs(n.dot(point[i].w)) > noise * 100.0)) return false;
  }
  return true;
}

}  // namespace

CoreDistance core_distance(const Problem& problem, ContactLevel level, double enough,
                           SolverCounts& counts) noexcept {
  if (problem.b.kind == ShapeKind::half_space) return half_space_distance(problem);
  const Vec known = axis_from_point(problem);
  if (known != Vec::Zero()) return distance_along(problem, known);
  const Core& a = problem.a;
  const Core& b = problem.b;
  const double noise = problem.noise();
  const Vec start = b.center == Vec::Zero() ? Vec(problem.tie_axes.col(0)) : b.center;
  // Level boolean needs no more than that the rounded cores overlap.
  const double near = level == ContactLevel::boolean ? a.rounding + b.rounding - 2.0 * noise : 0.0;
  GjkResult found =
      gjk(a, b, start, {.noise = kConvergence * noise, .enough = enough, .near = near});
  if (found.hit_limit) ++counts.bounded;
  CoreDistance answer;
  if (found.far) {
    answer.far = true;
    answer.distance = found.lower;
    answer.doubt = noise + std::max(found.upper - found.lower, 0.0);
    answer.axis = found.axis;
    answer.on_a = found.simplex.on_a();
    return answer;
  }
  if (level == ContactLevel::boolean && surely_overlap(problem, found)) {
    answer.overlaps = true;
    return answer;
  }
  if (found.contact) return penetration(problem, found, level, counts);
  AxisSearch search(a, b);
  search.test_axis(found.axis);
  search.test_axis(unit(found.between));
  if (found.upper - search.separation() > kConvergence * noise) test_simplex(found, search);
  const bool polytopes = is_polytope(a) && is_polytope(b);
  if (found.upper - search.separation() > kConvergence * noise) {
    const bool all = test_features(problem, search);
    if (!polytopes) refine_curved(a, b, search.axis(), noise, found);
    if (search.separation() <= 0.0 && (all || !polytopes)) {
      // If no axis separates polytopes, they overlap, whatever GJK found. Other cores overlap if
      // their proved depth is larger than GJK's upper bound of the distance.
      const CoreDistance inside = penetration(problem, found, level, counts);
      const bool proved = inside.distance + inside.doubt < -found.upper;
      if (polytopes || found.upper <= noise || proved) return inside;
      search.test_axis(inside.axis);
    }
  }
  return distance_apart(problem, found, search, counts);
}

}  // namespace winnow::solver
