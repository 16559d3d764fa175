// Prepares a pair for the solver: chooses the scale, places both cores in one frame, and scales
// results back to the caller's units.

#include "pipeline/solver/problem.h"
#include <winnow/core/pose.h>
#include "core/numbers/rotation.h"
#include "pipeline/kinds/kinds.h"

#include <algorithm>
#include <cmath>

namespace winnow::solver {
namespace {

void place_triangle(const TriangleShape& triangle, const Scale& scale, Core& core) noexcept {
  Vec local[3];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) local[i][k] = scale(triangle.vertex[i][k]);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    core.corner[i] = core.rotation * local[i];
    core.side[i] = core.rotation * unit(local[(i + 1) % 3] - local[i]);
    core.size = std::max(core.size, local[i].norm() + core.rounding);
  }
}

void place(const ShapeCore& shape, const Pose& pose, const Scale& scale, Core& core) noexcept {
  core.kind = shape.kind;
  core.corners = shape.corners;
  core.scale = scale;
  core.rotation = rotation_of(scale_to_unit_max(pose.orientation));
  for (int i = 0; i < 3; ++i) core.half[i] = scale(shape.half[i]);
  core.rounding = scale(shape.rounding);
  core.size = core.half.norm() + core.rounding;
  if (shape.triangle != nullptr) {
    place_triangle(*shape.triangle, scale, core);
  } else if (shape.support.function != nullptr) {
    core.farthest = shape.support;
    core.size += scale(core.farthest.radius);
  } else if (shape.hull != nullptr) {
    core.hull = shape.hull;
    core.size += scale(reach_of_vertices(*core.hull));
  } else if (shape.half_space != nullptr) {
    core.normal = unit(core.rotation * as_eigen(shape.half_space->normal));
    core.offset = scale(shape.half_space->offset);
    core.size = std::abs(core.offset);
  }
}

}  // namespace

void prepare(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
             const Pose& pose_b, bool mirrored, Problem& problem) noexcept {
  // Positions at opposite ends of the range of doubles have no finite difference: halve it.
  const auto at_a = as_eigen(pose_a.position);
  const auto at_b = as_eigen(pose_b.position);
  Vec c = at_b - at_a;
  const int halved = c.allFinite() ? 0 : 1;
  if (halved != 0) c = 0.5 * at_b - 0.5 * at_a;
  const ShapeCore core_a = core_of(tables, a);
  const ShapeCore core_b = core_of(tables, b);
  std::frexp(std::max({core_a.largest, core_b.largest, c.cwiseAbs().maxCoeff()}),
             &problem.exponent);
  problem.exponent += halved;
  const Scale scale(problem.exponent);
  for (int i = 0; i < 3; ++i) problem.b.center[i] = std::ldexp(c[i], halved - problem.exponent);
  place(core_a, pose_a, scale, problem.a);
  place(core_b, pose_b, scale, problem.b);
  problem.size = problem.b.center.norm() + problem.a.size + problem.b.size;
  problem.tie_axes = mirrored ? Mat(-problem.b.rotation) : problem.a.rotation;
}

bool move(const Vec& between, double largest, Problem& problem) noexcept {
  int exponent = 0;
  std::frexp(std::max(largest, between.cwiseAbs().maxCoeff()), &exponent);
  if (exponent != problem.exponent) return false;
  const Scale scale(exponent);
  for (int i = 0; i < 3; ++i) problem.b.center[i] = scale(between[i]);
  problem.size = problem.b.center.norm() + problem.a.size + problem.b.size;
  return true;
}

double largest_length(const ShapeTables& tables, ShapeId a, ShapeId b) noexcept {
  return std::max(core_of(tables, a).largest, core_of(tables, b).largest);
}

double unscaled(const Problem& problem, double length) noexcept {
  if (!std::isfinite(length)) return length;
  constexpr double kLargestDouble = std::numeric_limits<double>::max();
  return std::clamp(Scale(-problem.exponent)(length), -kLargestDouble, kLargestDouble);
}

}  // namespace winnow::solver
