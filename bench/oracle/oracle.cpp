// Distance and penetration depth of a pair in 100 digits. Calls widest_gap for two cores, and
// round_core for polytopes inside cylinders and cones.

#include "bench/oracle/oracle.h"

#include "bench/oracle/polytope.h"
#include "bench/oracle/round_core.h"
#include "bench/oracle/widest_gap.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace winnow::oracle {
namespace {

/// Lengths below this, relative to the larger shape of the pair, count as 0: shapes given by
/// doubles of moderate range cannot be closer without touching.
const Number kZero("1e-58");
/// Directions whose gaps differ by less than this part of the sizes count as equally good.
constexpr double kEquallyGood = 1e-9;
/// Error, relative to the sizes, to which polytopes inside round shapes are refined, and the limit
/// of refinement rounds.
constexpr double kClosed = 1e-13;
constexpr int kRounds = 12;

void set_distance(Truth& truth, const Number& scaled, const Number& unit_length) {
  const Number distance = abs(scaled) <= kZero ? Number(0) : Number(scaled * unit_length);
  truth.distance = distance.convert_to<long double>();
  truth.overlap = distance <= 0;
}

Vector<Number> difference(const Pose& a, const Pose& b) {
  return exact(b.position) - exact(a.position);
}

/// Returns a power of two that scales lengths up to `length` to the order of 1.
Number scale_for(const Number& length) {
  if (length == 0) return 1;
  int exponent = 0;
  frexp(length, &exponent);
  return ldexp(Number(1), -exponent);
}

/// Two cores, placed and scaled.
struct Placed {
  Polytope a;
  Polytope b;
  Number scale;
  Number sizes;
};

Placed place_pair(Polytope a, const Pose& pose_a, Polytope b, const Pose& pose_b) {
  Placed placed{std::move(a), std::move(b), 0, 0};
  placed.sizes = radius_of(placed.a) + radius_of(placed.b);
  const Vector<Number> between = difference(pose_a, pose_b);
  Number reach = length(between) + placed.sizes;
  for (const auto& v : placed.a.vertex) reach = std::max(reach, length(v));
  for (const auto& v : placed.b.vertex) reach = std::max(reach, length(v));
  placed.scale = scale_for(reach);
  place(placed.a, pose_a.orientation, {}, placed.scale);
  place(placed.b, pose_b.orientation, between, placed.scale);
  return placed;
}

WidestGap core_gap(const Placed& placed) {
  const double sizes = (placed.sizes * placed.scale).convert_to<double>();
  return widest_gap(placed.a, placed.b, std::max(kEquallyGood * sizes, 1e-30));
}

Truth truth_of(const Placed& placed, const WidestGap& gap) {
  Truth truth;
  truth.size = placed.sizes.convert_to<double>();
  truth.known = true;
  truth.normal_unique = gap.unique;
  truth.normal = rounded(gap.normal);
  set_distance(truth, gap.width - placed.a.rounding - placed.b.rounding, 1 / placed.scale);
  return truth;
}

/// A shape of a pair with a cylinder or a cone, and the direction near which its rims are refined.
struct Body {
  ShapeId shape;
  const Pose& pose;
  Vector<Number> aim;

  [[nodiscard]] Polytope core(const ShapeTables& tables) const {
    return has_polytope(shape.kind()) ? core_of(tables, shape) : inscribed(tables, shape, aim);
  }
  /// Rotates a world direction into the frame of the shape.
  [[nodiscard]] Vector<Number> local(const Vector<Number>& n) const {
    return rotate(pose.orientation.inverse(), n);
  }
};

/// Polytopes inside the shapes give an upper bound of the distance; the gap of the shapes along any
/// direction is a lower bound. Each round refines the rims where they are farthest along the
/// normal, until the bounds agree.
Truth of_round_shapes(const ShapeTables& tables, Body a, Body b) {
  const Vector<Number> between = difference(a.pose, b.pose);
  for (int round = 0; round < kRounds; ++round) {
    const Placed placed = place_pair(a.core(tables), a.pose, b.core(tables), b.pose);
    const WidestGap gap = core_gap(placed);
    const Vector<Number> n = gap.normal;
    a.aim = a.local(n);
    b.aim = b.local(n * Number(-1));
    const Number upper = (gap.width - placed.a.rounding - placed.b.rounding) / placed.scale;
    const Number lower = dot(n, between) + least_along(tables, a.shape, a.aim * Number(-1)) +
                         least_along(tables, b.shape, b.aim * Number(-1));
    if (upper - lower > Number(kClosed) * (placed.sizes + length(between))) continue;
    Truth truth = truth_of(placed, gap);
    truth.slack = (upper - lower).convert_to<double>();
    truth.known = upper <= 0 || lower > 0;
    return truth;
  }
  return {};
}

/// Solves a shape against a half-space; the normal is from the half-space to the shape.
Truth over_half_space(const ShapeTables& tables, ShapeId shape, const Pose& pose, ShapeId half,
                      const Pose& half_pose) {
  const HalfSpaceShape& plane = tables.half_spaces[half.index()];
  const Vector<Number> local = exact(plane.normal);
  const Number offset = plane.offset / length(local);
  const Vector<Number> n = rotate(half_pose.orientation, unit(local));
  const Number least = least_along(tables, shape, rotate(pose.orientation.inverse(), n));
  const Number radius =
      radius_of(has_polytope(shape.kind()) ? core_of(tables, shape) : inscribed(tables, shape, n));
  const Vector<Number> between = difference(half_pose, pose);
  const Number height = dot(n, between) + least - offset;
  const Number unit_length = length(between) + radius + abs(offset);
  Truth truth;
  truth.normal = rounded(n);
  set_distance(truth, unit_length == 0 ? height : Number(height / unit_length),
               unit_length == 0 ? Number(1) : unit_length);
  truth.size = (radius + abs(offset)).convert_to<double>();
  truth.normal_unique = true;
  truth.known = true;
  return truth;
}

}  // namespace

Truth solve(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
            const Pose& pose_b) {
  if (!pose_a.is_valid() || !pose_b.is_valid()) return {};
  if (a.kind() > ShapeKind::half_space || b.kind() > ShapeKind::half_space) return {};
  const bool a_is_half = a.kind() == ShapeKind::half_space;
  const bool b_is_half = b.kind() == ShapeKind::half_space;
  if (a_is_half && b_is_half) return {};
  if (a_is_half) return over_half_space(tables, b, pose_b, a, pose_a);
  if (b_is_half) {
    Truth truth = over_half_space(tables, a, pose_a, b, pose_b);
    truth.normal = -truth.normal;
    return truth;
  }
  if (!has_polytope(a.kind()) || !has_polytope(b.kind())) {
    return of_round_shapes(tables, {a, pose_a, {1, 0, 0}}, {b, pose_b, {1, 0, 0}});
  }
  const Placed placed = place_pair(core_of(tables, a), pose_a, core_of(tables, b), pose_b);
  return truth_of(placed, core_gap(placed));
}

}  // namespace winnow::oracle
