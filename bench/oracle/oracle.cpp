// Distance and penetration depth of a pair in 100 digits. Calls min_norm for cores apart,
// least_overlap for cores that overlap, and round_core for polytopes inside cylinders and cones.

#include "bench/oracle/oracle.h"

#include "bench/oracle/least_overlap.h"
#include "bench/oracle/min_norm.h"
#include "bench/oracle/polytope.h"
#include "bench/oracle/round_core.h"

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
/// Cosine of 0.1 degrees.
constexpr double kSameDirection = 0.99999847691328769;

void set_normal(Truth& truth, const Vector<Number>& n) {
  truth.normal[0] = n.x.convert_to<double>();
  truth.normal[1] = n.y.convert_to<double>();
  truth.normal[2] = n.z.convert_to<double>();
}

void set_distance(Truth& truth, const Number& scaled, const Number& unit_length) {
  const Number distance = abs(scaled) <= kZero ? Number(0) : Number(scaled * unit_length);
  truth.distance = distance.convert_to<long double>();
  truth.overlap = distance <= 0;
}

Vector<Number> difference(const Pose& a, const Pose& b) {
  return {Number(b.position[0]) - a.position[0], Number(b.position[1]) - a.position[1],
          Number(b.position[2]) - a.position[2]};
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
  place(placed.a, pose_a.orientation.data(), {}, placed.scale);
  place(placed.b, pose_b.orientation.data(), between, placed.scale);
  return placed;
}

/// Signed distance of the cores, its direction, and whether that direction is unique.
struct CoreGap {
  bool proven = false;
  Number width = 0;
  Vector<Number> normal;
  bool unique = false;
};

CoreGap core_gap(const Placed& placed) {
  CoreGap gap;
  Simplex simplex{{{0, 0}}};
  static_cast<void>(nearest_point<double>(placed.a, placed.b, simplex));
  const Nearest<Number> nearest = nearest_point<Number>(placed.a, placed.b, simplex);
  if (!nearest.proven) return gap;
  gap.proven = true;
  const double slack =
      std::max(kEquallyGood * (placed.sizes * placed.scale).convert_to<double>(), 1e-30);
  if (nearest.upper > kZero) {
    gap.width = nearest.upper;
    gap.normal = nearest.point * (1 / nearest.upper);
    gap.unique = nearest.upper > Number(slack);
    return gap;
  }
  const LeastOverlap least = least_overlap(placed.a, placed.b, slack);
  const auto& best = least.direction.front();
  gap.width = best.gap;
  gap.normal = best.normal;
  gap.unique = std::all_of(least.direction.begin(), least.direction.end(), [&](const auto& d) {
    return dot(d.normal, best.normal) > kSameDirection;
  });
  return gap;
}

Truth truth_of(const Placed& placed, const CoreGap& gap) {
  Truth truth;
  truth.size = placed.sizes.convert_to<double>();
  if (!gap.proven) return truth;
  truth.known = true;
  truth.normal_unique = gap.unique;
  set_normal(truth, gap.normal);
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
    const double* q = pose.orientation.data();
    const double back[4] = {q[0], -q[1], -q[2], -q[3]};
    return rotate(back, n);
  }
};

/// Polytopes inside the shapes give an upper bound of the distance; the gap of the shapes along any
/// direction is a lower bound. Each round refines the rims where they are farthest along the
/// normal, until the bounds agree.
Truth of_round_shapes(const ShapeTables& tables, Body a, Body b) {
  const Vector<Number> between = difference(a.pose, b.pose);
  for (int round = 0; round < kRounds; ++round) {
    const Placed placed = place_pair(a.core(tables), a.pose, b.core(tables), b.pose);
    const CoreGap gap = core_gap(placed);
    if (!gap.proven) return {};
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
  Vector<Number> n{plane.normal[0], plane.normal[1], plane.normal[2]};
  const Number offset = plane.offset / length(n);
  n = rotate(half_pose.orientation.data(), n * (1 / length(n)));
  const double back[4] = {pose.orientation[0], -pose.orientation[1], -pose.orientation[2],
                          -pose.orientation[3]};
  const Number least = least_along(tables, shape, rotate(back, n));
  const Number radius =
      radius_of(has_polytope(shape.kind()) ? core_of(tables, shape) : inscribed(tables, shape, n));
  const Vector<Number> between = difference(half_pose, pose);
  const Number height = dot(n, between) + least - offset;
  const Number unit_length = length(between) + radius + abs(offset);
  Truth truth;
  set_normal(truth, n);
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
    for (double& x : truth.normal) x = -x;
    return truth;
  }
  if (!has_polytope(a.kind()) || !has_polytope(b.kind())) {
    return of_round_shapes(tables, {a, pose_a, {1, 0, 0}}, {b, pose_b, {1, 0, 0}});
  }
  const Placed placed = place_pair(core_of(tables, a), pose_a, core_of(tables, b), pose_b);
  return truth_of(placed, core_gap(placed));
}

}  // namespace winnow::oracle
