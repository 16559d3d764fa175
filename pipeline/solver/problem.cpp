// Prepares a pair for the solver: chooses the scale, places both cores in one frame, and scales
// results back to the caller's units.

#include "pipeline/solver/problem.h"
#include <winnow/core/rotation.h>

#include <algorithm>
#include <cmath>

namespace winnow::solver {
namespace {

/// The lengths of a shape in the caller's units.
struct Lengths {
  CoreKind kind = CoreKind::point;
  Vec half = Vec::Zero();
  double rounding = 0.0;
  double largest = 0.0;
};

Lengths triangle_lengths(const TriangleShape& triangle) noexcept {
  Lengths lengths{CoreKind::triangle, Vec::Zero(), triangle.rounding, triangle.rounding};
  for (const auto& corner : triangle.vertex) {
    for (const double x : corner) lengths.largest = std::max(lengths.largest, std::abs(x));
  }
  return lengths;
}

/// Upper bound of the distance of the vertices from the position; finite even if the hull's numbers
/// are not.
double reach(const HullShape& hull) noexcept {
  const double sum = Eigen::Map<const Vec>(hull.center).cwiseAbs().sum() + hull.radius;
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::max();
}

Lengths hull_lengths(const HullShape& hull) noexcept {
  Lengths lengths{CoreKind::hull, Vec::Zero(), hull.rounding, hull.rounding};
  lengths.largest = std::max(lengths.largest, reach(hull));
  return lengths;
}

SupportCore core_of(const ShapeTables& tables, ShapeId id) noexcept {
  return id.kind() == ShapeKind::ellipsoid ? eroded_core(tables.ellipsoids[id.index()])
                                           : support_core(tables, id);
}

Lengths support_lengths(const SupportCore& core) noexcept {
  return {CoreKind::support, Vec::Zero(), core.rounding, std::max(core.radius, core.rounding)};
}

Lengths lengths_of(const ShapeTables& tables, ShapeId id) noexcept {
  const auto with = [](CoreKind kind, const Vec& half, double rounding) {
    return Lengths{kind, half, rounding, std::max(half.maxCoeff(), rounding)};
  };
  switch (id.kind()) {
    case ShapeKind::sphere:
      return with(CoreKind::point, Vec::Zero(), tables.spheres[id.index()].radius);
    case ShapeKind::capsule: {
      const CapsuleShape& s = tables.capsules[id.index()];
      const CoreKind kind = s.half_length > 0.0 ? CoreKind::segment : CoreKind::point;
      return with(kind, {0.0, 0.0, s.half_length}, s.radius);
    }
    case ShapeKind::box: {
      const BoxShape& s = tables.boxes[id.index()];
      return with(CoreKind::box, {s.half[0], s.half[1], s.half[2]}, s.rounding);
    }
    case ShapeKind::cylinder: {
      const CylinderShape& s = tables.cylinders[id.index()];
      const CoreKind kind = s.radius > 0.0 ? CoreKind::cylinder : CoreKind::segment;
      return with(kind, {s.radius, s.radius, s.half_length}, s.rounding);
    }
    case ShapeKind::cone: {
      const ConeShape& s = tables.cones[id.index()];
      const CoreKind kind = s.radius > 0.0 ? CoreKind::cone : CoreKind::segment;
      return with(kind, {s.radius, s.radius, s.half_length}, s.rounding);
    }
    case ShapeKind::hull:
      return hull_lengths(tables.hulls[id.index()]);
    case ShapeKind::triangle:
      return triangle_lengths(tables.triangles[id.index()]);
    case ShapeKind::ellipsoid:
    case ShapeKind::tapered_capsule:
    case ShapeKind::support:
      return support_lengths(core_of(tables, id));
    case ShapeKind::half_space:
      break;
  }
  const double offset = tables.half_spaces[id.index()].offset;
  return {CoreKind::half_space, Vec::Zero(), 0.0, std::abs(offset)};
}

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

void set_units(int exponent, Core& core) noexcept {
  core.unit[0] = std::ldexp(1.0, -exponent / 2);
  core.unit[1] = std::ldexp(1.0, -exponent - -exponent / 2);
}

void place(const ShapeTables& tables, ShapeId id, const Pose& pose, const Lengths& lengths,
           int exponent, const Scale& scale, Core& core) noexcept {
  core.kind = lengths.kind;
  core.rotation = rotation_of(scale_to_unit_max(pose.orientation));
  for (int i = 0; i < 3; ++i) core.half[i] = scale(lengths.half[i]);
  core.rounding = scale(lengths.rounding);
  core.size = core.half.norm() + core.rounding;
  if (id.kind() == ShapeKind::triangle) {
    place_triangle(tables.triangles[id.index()], scale, core);
  } else if (lengths.kind == CoreKind::support) {
    core.farthest = core_of(tables, id);
    set_units(exponent, core);
    core.size += scale(core.farthest.radius);
  } else if (id.kind() == ShapeKind::hull) {
    core.hull = &tables.hulls[id.index()];
    set_units(exponent, core);
    core.size += reach(*core.hull) * core.unit[0] * core.unit[1];
  } else if (id.kind() == ShapeKind::half_space) {
    const HalfSpaceShape& shape = tables.half_spaces[id.index()];
    core.normal = unit(core.rotation * Eigen::Map<const Vec>(shape.normal));
    core.offset = scale(shape.offset);
    core.size = std::abs(core.offset);
  }
}

}  // namespace

void prepare(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
             const Pose& pose_b, bool mirrored, Problem& problem) noexcept {
  // Positions at opposite ends of the range of doubles have no finite difference: halve it.
  const Eigen::Map<const Vec> at_a(pose_a.position);
  const Eigen::Map<const Vec> at_b(pose_b.position);
  Vec c = at_b - at_a;
  const int halved = c.allFinite() ? 0 : 1;
  if (halved != 0) c = 0.5 * at_b - 0.5 * at_a;
  const Lengths lengths_a = lengths_of(tables, a);
  const Lengths lengths_b = lengths_of(tables, b);
  std::frexp(std::max({lengths_a.largest, lengths_b.largest, c.cwiseAbs().maxCoeff()}),
             &problem.exponent);
  problem.exponent += halved;
  const Scale scale(problem.exponent);
  for (int i = 0; i < 3; ++i) problem.b.center[i] = std::ldexp(c[i], halved - problem.exponent);
  place(tables, a, pose_a, lengths_a, problem.exponent, scale, problem.a);
  place(tables, b, pose_b, lengths_b, problem.exponent, scale, problem.b);
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
  return std::max(lengths_of(tables, a).largest, lengths_of(tables, b).largest);
}

double unscaled(const Problem& problem, double length) noexcept {
  if (!std::isfinite(length)) return length;
  constexpr double kLargestDouble = std::numeric_limits<double>::max();
  return std::clamp(Scale(-problem.exponent)(length), -kLargestDouble, kLargestDouble);
}

}  // namespace winnow::solver
