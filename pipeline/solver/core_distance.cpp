#include "pipeline/solver/core_distance.h"

#include "pipeline/solver/axis_search.h"
#include "pipeline/solver/closest_features.h"
#include "pipeline/solver/expanding_polytope.h"
#include "pipeline/solver/gjk.h"
#include "pipeline/solver/revolution.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace winnow::solver {
namespace {

/// Up to so many products of edges, trying all axes is cheaper than growing a polytope.
constexpr std::uint32_t kFewProducts = 40;
/// What the depth of cylinders and cones is proved to, relative to the sizes.
constexpr double kSmoothTolerance = 1e-11;

CoreDistance half_space_distance(const Problem& problem) noexcept {
  const Core& a = problem.a;
  const Core& b = problem.b;
  CoreDistance found;
  found.doubt = problem.noise();
  if (a.kind == CoreKind::half_space) {
    found.axis = a.normal;
    found.on_a = a.normal * a.offset;
    if ((a.normal + b.normal).cwiseAbs().maxCoeff() <= 4.0 * kEpsilon) {
      found.distance = a.normal.dot(b.center) - b.offset - a.offset;
    } else {
      // No translation parts them.
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

/// Axes for pairs of segments, points and triangles without area: perpendicular to their line.
void look_across_line(const Problem& problem, AxisSearch& search) noexcept {
  Vec line = Vec::Zero();
  for (const Core* core : {&problem.a, &problem.b}) {
    const bool is_line =
        core->kind == CoreKind::hull ? core->hull->dimension < 2 : core->kind <= CoreKind::triangle;
    if (!is_line || core->kind == CoreKind::box) return;
    for (std::uint32_t i = 0; i < direction_count(*core) && line == Vec::Zero(); ++i) {
      line = unit(direction(*core, i));
    }
  }
  // Two points have no line: any axis will do.
  for (int i = 0; i < 3; ++i) search.look(without(problem.tie_axes.col(i), line));
}

/// Of axes that are as good as the best, the first of the caller's frame.
void break_ties(const Problem& problem, double separated, Vec& axis) noexcept {
  for (int i = 0; i < 6; ++i) {
    const Vec candidate = problem.tie_axes.col(i / 2) * (i % 2 == 0 ? 1.0 : -1.0);
    const double along = separation(problem.a, problem.b, candidate);
    if (along < separated - 0.25 * problem.noise()) continue;
    axis = candidate;
    return;
  }
}

/// Where curved cores nearly touch, the iteration comes close but slowly; along a good axis the
/// parts of them that meet are straight, and closest at once.
void refine_curved(const Core& a, const Core& b, const Vec& axis, double noise,
                   GjkResult& found) noexcept {
  const Core straight_a = meridian(a, axis);
  const Core straight_b = meridian(b, -axis);
  for (const auto& [x, y] :
       {std::pair{&straight_a, &straight_b}, {&straight_a, &b}, {&a, &straight_b}}) {
    const GjkResult straight =
        gjk(*x, *y, axis, 0.125 * noise, std::numeric_limits<double>::infinity());
    if (!straight.contact && !(straight.upper < found.upper)) continue;
    found.simplex = straight.simplex;
    found.between = straight.between;
    found.upper = straight.upper;
    found.contact = straight.contact;
    if (found.contact) return;
  }
}

/// A point that is on both cores once b has been moved out along the axis.
Vec meeting_point(const Problem& problem, const Vec& axis, double depth) noexcept {
  const Core& a = problem.a;
  const double noise = problem.noise();
  Core moved = problem.b;
  moved.center += axis * depth;
  GjkResult met = gjk(a, moved, axis, 0.125 * noise, std::numeric_limits<double>::infinity());
  Vec x = met.simplex.on_a();
  // A flat tetrahedron has the origin inside, but does not tell well where.
  met.upper = met.simplex.closest().norm();
  if (met.upper > 0.25 * noise && a.is_polytope() && moved.is_polytope()) {
    ClosestPoints points;
    if (closest_features(a, moved, axis, 0.0, met.upper, noise, points)) x = points.on_a;
  } else if (met.upper > 0.25 * noise) {
    refine_curved(a, moved, axis, noise, met);
    x = met.simplex.on_a();
  }
  return x + axis * (project(a, axis).high - axis.dot(x - a.center));
}

CoreDistance closest(const Problem& problem, const GjkResult& start, const AxisSearch& search,
                     SolverCounts& counts) noexcept {
  CoreDistance found;
  const double noise = problem.noise();
  double upper = start.upper;
  Vec between = start.between;
  found.on_a = start.simplex.on_a();
  double gap = upper - search.separation();
  const bool polytopes = problem.a.is_polytope() && problem.b.is_polytope();
  if (gap > 0.25 * noise && polytopes) {
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
  // Short vectors have no good direction; of long ones no axis is better.
  const bool is_long = upper > 1e-4 * problem.size;
  found.axis = is_long || search.axis() == Vec::Zero() ? unit(between) : search.axis();
  if (found.axis == Vec::Zero()) found.axis = problem.tie_axes.col(0);
  return found;
}

/// Depth along the best axis of all, or the distance if that axis separates.
CoreDistance penetration(const Problem& problem, const GjkResult& start, NarrowLevel level,
                         SolverCounts& counts) noexcept {
  const Core& a = problem.a;
  const Core& b = problem.b;
  const double noise = problem.noise();
  const bool polytopes = a.is_polytope() && b.is_polytope();
  AxisSearch search(a, b);
  double gap = 0.0;
  const bool few = std::uint64_t{direction_count(a)} * direction_count(b) <= kFewProducts &&
                   normal_count(a) + normal_count(b) <= kFewProducts;
  if (polytopes && few) {
    look_at_features(problem, search);
    look_across_line(problem, search);
  } else if (!look_at_revolution(problem, search)) {
    const double tolerance = polytopes ? noise : kSmoothTolerance * problem.size;
    const DepthBounds bounds = expand(a, b, start.simplex, noise, tolerance);
    search.look(bounds.axis);
    gap = -search.separation() - bounds.lower;
    if (!polytopes || gap > 4.0 * noise) {
      if (polytopes) ++counts.bounded;
      const bool all = look_at_features(problem, search);
      look_across_line(problem, search);
      gap = polytopes && all ? 0.0 : -search.separation() - bounds.lower;
      if (!polytopes && gap > 2.0 * tolerance) ++counts.bounded;
    }
  }
  CoreDistance found;
  found.axis = search.axis();
  found.distance = search.separation();
  break_ties(problem, found.distance, found.axis);
  found.doubt = noise + std::max(gap, 0.0);
  if (level != NarrowLevel::boolean) {
    found.on_a = meeting_point(problem, found.axis, -found.distance);
  }
  return found;
}

/// That the cores overlap, shown by a simplex with the origin well inside or by their roundings.
bool surely_overlap(const Problem& problem, const GjkResult& start) noexcept {
  const double roundings = problem.a.rounding + problem.b.rounding;
  const double noise = problem.noise();
  if (start.upper + noise < roundings) return true;
  if (!start.simplex.inside) return false;
  constexpr std::size_t kFace[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};
  const auto& point = start.simplex.point;
  for (const auto& [i, j, k] : kFace) {
    const Vec e = point[j].w - point[i].w;
    const Vec f = point[k].w - point[i].w;
    const Vec n = perpendicular(unit(e), unit(f));
    // Slivers have no good normal.
    if (unit(e).cross(unit(f)).squaredNorm() < 1e-4) return false;
    if (!(std::abs(n.dot(point[i].w)) > noise * 100.0)) return false;
  }
  return true;
}

}  // namespace

CoreDistance core_distance(const Problem& problem, NarrowLevel level, double enough,
                           SolverCounts& counts) noexcept {
  if (problem.b.kind == CoreKind::half_space) return half_space_distance(problem);
  const Core& a = problem.a;
  const Core& b = problem.b;
  const double noise = problem.noise();
  const Vec start = b.center == Vec::Zero() ? Vec(problem.tie_axes.col(0)) : b.center;
  GjkResult found = gjk(a, b, start, 0.125 * noise, enough);
  if (found.bounded) ++counts.bounded;
  CoreDistance answer;
  if (found.far) {
    answer.far = true;
    answer.distance = found.lower;
    answer.doubt = noise + (found.upper - found.lower);
    answer.axis = found.axis;
    answer.on_a = found.simplex.on_a();
    return answer;
  }
  if (level == NarrowLevel::boolean && surely_overlap(problem, found)) {
    answer.overlaps = true;
    return answer;
  }
  if (found.contact) return penetration(problem, found, level, counts);
  AxisSearch search(a, b);
  search.look(found.axis);
  search.look(unit(found.between));
  if (found.upper - search.separation() > 0.125 * noise) look_at_simplex(found, search);
  const bool polytopes = a.is_polytope() && b.is_polytope();
  if (found.upper - search.separation() > 0.125 * noise) {
    const bool all = look_at_features(problem, search);
    if (!polytopes) refine_curved(a, b, search.axis(), noise, found);
    // No axis separates them: they overlap, whatever the simplices said.
    const bool sure = polytopes ? all : found.upper <= noise;
    if (sure && search.separation() <= 0.0) return penetration(problem, found, level, counts);
  }
  return closest(problem, found, search, counts);
}

}  // namespace winnow::solver
