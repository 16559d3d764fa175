#include "oracle/oracle.h"

#include "oracle/least_overlap.h"
#include "oracle/min_norm.h"
#include "oracle/polytope.h"

#include <algorithm>
#include <cmath>

namespace winnow::oracle {
namespace {

/// Lengths below this, where the larger of the pair is 1, are 0: no pair of doubles of moderate
/// range comes closer without touching.
const Number kZero("1e-58");
/// Directions that are as good to within this part of the sizes are equally good.
constexpr double kEquallyGood = 1e-9;
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

/// A power of two that brings lengths up to `length` to the order of 1.
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

Placed place_pair(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
                  const Pose& pose_b) {
  Placed placed{core_of(tables, a), core_of(tables, b), 0, 0};
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

Truth of_polytopes(const Placed& placed) {
  Truth truth;
  truth.size = placed.sizes.convert_to<double>();
  Simplex simplex{{{0, 0}}};
  static_cast<void>(nearest_point<double>(placed.a, placed.b, simplex));
  const Nearest<Number> nearest = nearest_point<Number>(placed.a, placed.b, simplex);
  if (!nearest.proven) return truth;
  const Number rounding = placed.a.rounding + placed.b.rounding;
  const double slack =
      std::max(kEquallyGood * (placed.sizes * placed.scale).convert_to<double>(), 1e-30);
  if (nearest.upper > kZero) {
    set_normal(truth, nearest.point * (1 / nearest.upper));
    set_distance(truth, nearest.upper - rounding, 1 / placed.scale);
    truth.normal_unique = nearest.upper > Number(slack);
  } else {
    const LeastOverlap least = least_overlap(placed.a, placed.b, slack);
    const auto& best = least.direction.front();
    set_normal(truth, best.normal);
    set_distance(truth, best.gap - rounding, 1 / placed.scale);
    truth.normal_unique =
        std::all_of(least.direction.begin(), least.direction.end(),
                    [&](const auto& d) { return dot(d.normal, best.normal) > kSameDirection; });
  }
  truth.known = true;
  return truth;
}

/// The least of n.x over a shape in its own frame, for a direction of length 1.
Number least_along(const ShapeTables& tables, ShapeId shape, const Vector<Number>& n,
                   Number& radius) {
  const auto round = [&](double disc, double half, double rounding, bool apex) {
    const Number side = sqrt(n.x * n.x + n.y * n.y) * disc;
    radius = sqrt(Number(disc) * disc + Number(half) * half) + rounding;
    const Number top = n.z * half - (apex ? Number(0) : side);
    return std::min(top, Number(-n.z * half - side)) - rounding;
  };
  const std::uint32_t i = shape.index();
  if (shape.kind() == ShapeKind::cylinder) {
    const CylinderShape& s = tables.cylinders[i];
    return round(s.radius, s.half_length, s.rounding, false);
  }
  if (shape.kind() == ShapeKind::cone) {
    const ConeShape& s = tables.cones[i];
    return round(s.radius, s.half_length, s.rounding, true);
  }
  const Polytope core = core_of(tables, shape);
  radius = radius_of(core);
  Number least = dot(n, core.vertex.front());
  for (const auto& v : core.vertex) least = std::min(least, dot(n, v));
  return least - core.rounding;
}

/// A shape over a half-space; the normal is from the half-space to the shape.
Truth over_half_space(const ShapeTables& tables, ShapeId shape, const Pose& pose, ShapeId half,
                      const Pose& half_pose) {
  const HalfSpaceShape& plane = tables.half_spaces[half.index()];
  Vector<Number> n{plane.normal[0], plane.normal[1], plane.normal[2]};
  const Number offset = plane.offset / length(n);
  n = rotate(half_pose.orientation, n * (1 / length(n)));
  const double back[4] = {pose.orientation[0], -pose.orientation[1], -pose.orientation[2],
                          -pose.orientation[3]};
  Number radius;
  const Number least = least_along(tables, shape, rotate(back, n), radius);
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
  const bool a_is_half = a.kind() == ShapeKind::half_space;
  const bool b_is_half = b.kind() == ShapeKind::half_space;
  if (a_is_half && b_is_half) return {};
  if (a_is_half) return over_half_space(tables, b, pose_b, a, pose_a);
  if (b_is_half) {
    Truth truth = over_half_space(tables, a, pose_a, b, pose_b);
    for (double& x : truth.normal) x = -x;
    return truth;
  }
  if (!has_polytope(a.kind()) || !has_polytope(b.kind())) return {};
  return of_polytopes(place_pair(tables, a, pose_a, b, pose_b));
}

}  // namespace winnow::oracle
