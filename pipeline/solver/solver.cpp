#include "pipeline/solver/solver.h"

#include "pipeline/exact/exact_overlap.h"
#include "pipeline/shapes/pair_order.h"
#include "pipeline/solver/core_distance.h"
#include "pipeline/solver/manifold.h"
#include "pipeline/solver/problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

using solver::CoreDistance;
using solver::Problem;
using solver::Vec;

struct PairQuery {
  const ShapeTables& tables;
  ShapeId a;
  const Pose& pose_a;
  ShapeId b;
  const Pose& pose_b;
};

/// True if the pair is solved as (b, a): shapes of two kinds in the order that `prepare` requires,
/// others in the order of their positions. The order does not depend on which shape is called a, so
/// that the answers for (a, b) and (b, a) mirror each other; except for two shapes of one kind at
/// the same position.
bool is_solved_mirrored(ShapeId a, const Pose& pose_a, ShapeId b, const Pose& pose_b) noexcept {
  if (a.kind() != b.kind()) return solver::is_prepared_mirrored(a.kind(), b.kind());
  for (int i = 0; i < 3; ++i) {
    if (pose_b.position[i] != pose_a.position[i]) return pose_b.position[i] < pose_a.position[i];
  }
  return false;
}

/// Decides the sign of a distance by exact arithmetic if double cannot.
void settle_sign(const PairQuery& query, const Problem& problem, const Vec& axis, double& distance,
                 SolverCounts& counts) noexcept {
  ++counts.exact;
  const double direction[3] = {axis.x(), axis.y(), axis.z()};
  switch (exact_overlap(query.tables, query.a, query.pose_a, query.b, query.pose_b, direction)) {
    case ExactVerdict::separated:
      distance = std::max(distance, std::numeric_limits<double>::denorm_min());
      break;
    case ExactVerdict::touching:
      distance = 0.0;
      break;
    case ExactVerdict::overlapping:
      distance = std::min(distance, 0.0);
      break;
    case ExactVerdict::undecided:
      if (std::abs(distance) <= unscaled(problem, 4.0 * solver::kEpsilon * problem.size)) {
        distance = 0.0;
      }
      break;
  }
}

void put(const Problem& problem, const Vec& from, double to[3]) noexcept {
  for (int i = 0; i < 3; ++i) to[i] = unscaled(problem, from[i]);
}

PairAnswer solve(const PairQuery& query, bool mirrored, ContactLevel level, double margin,
                 SolverCounts& counts) noexcept {
  Problem problem;
  prepare(query.tables, query.a, query.pose_a, query.b, query.pose_b, mirrored, problem);
  const double roundings = problem.a.rounding + problem.b.rounding;
  double enough = std::numeric_limits<double>::infinity();
  if (level != ContactLevel::distance) {
    enough = roundings + problem.noise();
    if (level == ContactLevel::manifold) enough += std::ldexp(margin, -problem.exponent);
  }
  const CoreDistance found = core_distance(problem, level, enough, counts);
  PairAnswer answer;
  if (found.overlaps) {
    answer.overlap = true;
    return answer;
  }
  const double scaled = found.distance - roundings;
  answer.distance = unscaled(problem, scaled);
  answer.error_bound = unscaled(problem, found.doubt);
  if (!found.far && std::isfinite(found.doubt) && std::abs(scaled) <= found.doubt) {
    settle_sign(query, problem, found.axis, answer.distance, counts);
  }
  answer.overlap = answer.distance <= 0.0;
  as_eigen(answer.normal) = found.axis;
  const Vec point = found.on_a + found.axis * problem.a.rounding;
  put(problem, point, answer.point.data());
  if (level == ContactLevel::manifold && answer.distance <= margin) {
    // Lengths are about 1 here, and no two contact points are 8 apart: a larger margin, which may
    // be infinite when scaled, has the same effect.
    const double reach = std::min(std::ldexp(margin, -problem.exponent), 8.0);
    make_manifold(problem, point, scaled, reach, answer);
  }
  return answer;
}

}  // namespace

PairAnswer solve_pair(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
                      const Pose& pose_b, ContactLevel level, double margin,
                      SolverCounts& counts) noexcept {
  if (!is_solved_mirrored(a, pose_a, b, pose_b)) {
    return solve({tables, a, pose_a, b, pose_b}, false, level, margin, counts);
  }
  PairAnswer answer = solve({tables, b, pose_b, a, pose_a}, true, level, margin, counts);
  mirror(pose_a, pose_b, answer);
  return answer;
}

void mirror(const Pose& pose_a, const Pose& pose_b, PairAnswer& answer) noexcept {
  for (int i = 0; i < 3; ++i) {
    const double apart = pose_a.position[i] - pose_b.position[i];
    answer.point[i] = mirrored_point(answer.point[i], answer.distance * answer.normal[i], apart);
    answer.normal[i] = -answer.normal[i];
    for (std::uint32_t k = 0; k < answer.contact_count; ++k) {
      float& x = answer.contacts[k].position[i];
      x = mirrored_position(x, apart);
    }
  }
  for (std::uint32_t k = 0; k < answer.contact_count; ++k) {
    std::uint64_t& feature = answer.contacts[k].feature;
    feature = mirrored_feature(feature);
  }
}

}  // namespace winnow
