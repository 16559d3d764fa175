#pragma once

// Closed forms for the closest points of two cores: a point and any core except hulls and user
// shapes; a segment and a segment or triangle (by the narrow phase's kernels/round); any core and a
// half-space.

#include "pipeline/motion/closest_cores.wide.h"

namespace winnow::WINNOW_ISA_NAME::impact {

/// Returns whether the closest points of a pair of kinds (in the solver's order) are computed
/// without GJK.
[[nodiscard]] constexpr bool has_closed_form(ShapeKind a, ShapeKind b) {
  if (b == ShapeKind::half_space) return true;
  const bool of_segment = b == ShapeKind::capsule || b == ShapeKind::triangle;
  if (a == ShapeKind::sphere) return b == ShapeKind::sphere || of_segment || has_nearest(b);
  return a == ShapeKind::capsule && of_segment;
}

/// The vector from the closest point of a to the closest point of b, and the point of a relative to
/// a's centre.
struct ClosestVector {
  Vector way;
  Vector on_a;
};

[[gnu::always_inline]] inline ClosestVector closest_vector(const CorePair& pair) {
  const Doubles zero(0.0);
  const bool is_point = pair.table_a.kind == ShapeKind::sphere;
  if (pair.table_b.kind == ShapeKind::sphere) return {pair.between, zero_vector()};
  if (pair.table_b.kind == ShapeKind::triangle) {
    const Vector u = is_point ? zero_vector() : pair.b.axes.to_local(pair.a.axes.z);
    const Doubles half = is_point ? zero : pair.a.half.z;
    const auto nearest =
        nearest_of_triangle(pair.b, pair.b.axes.to_local(pair.between), u, half, is_point);
    return {pair.b.axes.to_world(nearest.w), is_point ? zero_vector() : pair.a.axes.z * nearest.s};
  }
  if (is_point && pair.table_b.kind == ShapeKind::capsule) {
    const Vector& axis = pair.b.axes.z;
    const Doubles& half = pair.b.half.z;
    return {pair.between + axis * min(max(-dot(pair.between, axis), -half), half), zero_vector()};
  }
  if (is_point) {
    const Vector nearest = nearest_to(pair.table_b, pair.b, pair.b.axes.to_local(-pair.between));
    return {pair.between + pair.b.axes.to_world(nearest), zero_vector()};
  }
  const Vector& u = pair.a.axes.z;
  const Vector& e = pair.b.axes.z;
  const Vector across = cross(u, e);
  const auto feet = round::closest_feet(
      u, pair.a.half.z, {pair.between, e, Doubles(1.0), -pair.b.half.z, pair.b.half.z}, across,
      Doubles(1.0) / dot(across, across));
  return {pair.between + e * feet.t - u * feet.s, u * feet.s};
}

/// Closest points of a core and a half-space that are disjoint.
static inline ClosestLanes closest_to_half_space(const CorePair& pair, Mask16 lanes) {
  ClosestLanes found;
  found.axis = -pair.b.axes.to_world(pair.b.half);
  const Vector own = pair.own_facing(pair.table_a, pair.a, found.axis, lanes);
  found.on_a = pair.on_a(own);
  found.high_a = dot(found.axis, found.on_a);
  found.high_b = pair.b.corner[0].x;
  found.lower = dot(found.axis, pair.between) - found.high_a - found.high_b;
  found.upper = positive_part(found.lower);
  found.between = found.axis * found.upper;
  found.on_b = found.between + found.on_a - pair.between;
  return found;
}

/// Closest points of cores whose kinds have a closed form. The lower bound is proved by the support
/// functions along the vector between the closest points.
static inline ClosestLanes closest_by_form(const CorePair& pair, Mask16 lanes) {
  if (pair.table_b.kind == ShapeKind::half_space) return closest_to_half_space(pair, lanes);
  const ClosestVector closest = closest_vector(pair);
  ClosestLanes found;
  found.between = closest.way;
  found.upper = length(closest.way);
  found.axis = closest.way * (Doubles(1.0) / found.upper);
  found.on_a = closest.on_a;
  found.on_b = closest.way + closest.on_a - pair.between;
  found.high_a = pair.height(pair.table_a, pair.a, found.axis, 0);
  found.high_b = pair.height(pair.table_b, pair.b, -found.axis, 0);
  found.lower = dot(found.axis, pair.between) - found.high_a - found.high_b;
  return found;
}

/// Returns whether `closing_square` supports a pair of kinds.
[[nodiscard]] constexpr bool has_closing_square(ShapeKind a, ShapeKind b) {
  const bool of_segment = b == ShapeKind::capsule || b == ShapeKind::triangle;
  return (a == ShapeKind::sphere && (of_segment || b == ShapeKind::box)) ||
         (a == ShapeKind::capsule && of_segment);
}

/// The squared length of a velocity without its component along the closest feature of a core.
struct FeatureAcross {
  Doubles square;
  /// The lanes in which the feature is an edge or a face, not a vertex.
  DoubleMask goes;
};

[[gnu::always_inline]] inline FeatureAcross across_segment(const MovingCore& core,
                                                           const Vector& point,
                                                           const Vector& velocity) {
  const Vector& axis = core.axes.z;
  const DoubleMask inside = abs(dot(point, axis)) < core.half.z * Doubles(1.0 - 1e-9);
  const Doubles along = select(inside, dot(velocity, axis), Doubles(0.0));
  return {dot(velocity, velocity) - along * along, inside};
}

/// For a triangle in the world frame. The direction to its closest point is orthogonal to the edge
/// that contains the point, or to all edges if the point is in the face.
[[gnu::always_inline]] inline FeatureAcross across_triangle(const MovingCore& core,
                                                            const Vector& axis,
                                                            const Vector& velocity) {
  const Doubles zero(0.0);
  const Doubles slope = dot(axis, velocity);
  DoubleMask one = zero > zero;
  DoubleMask two = one;
  Doubles along = zero;
  for (int i = 0; i < 3; ++i) {
    const Vector edge = core.corner[(i + 1) % 3] - core.corner[i];
    const Doubles square = dot(edge, edge);
    const Doubles across = dot(edge, axis);
    const DoubleMask is_square = across * across <= square * Doubles(1e-18);
    const Doubles share = dot(edge, velocity);
    const Doubles on = share * share / select(square > zero, square, Doubles(1.0));
    along = max(along, select(is_square, on, zero));
    two = two | (one & is_square);
    one = one | is_square;
  }
  return {select(two, slope * slope, dot(velocity, velocity) - along), one};
}

/// Returns the squared length of a velocity without its components along the closest features.
/// While these features are the closest, the distance of two cores that do not rotate changes like
/// the distance of a point that moves with the remaining velocity.
static inline Doubles closing_square(const CorePair& pair, const ClosestLanes& closest,
                                     const Vector& velocity) {
  const Doubles zero(0.0);
  if (pair.table_b.kind == ShapeKind::box) {
    const Vector p = pair.b.axes.to_local(pair.between);
    const Vector v = pair.b.axes.to_local(velocity);
    const Vector& half = pair.b.half;
    const Vector across{select(abs(p.x) < half.x, zero, v.x), select(abs(p.y) < half.y, zero, v.y),
                        select(abs(p.z) < half.z, zero, v.z)};
    return dot(across, across);
  }
  const FeatureAcross of_b = pair.table_b.kind == ShapeKind::triangle
                                 ? across_triangle(pair.b, closest.axis, velocity)
                                 : across_segment(pair.b, closest.on_b, velocity);
  if (pair.table_a.kind == ShapeKind::sphere) return of_b.square;
  const FeatureAcross of_a = across_segment(pair.a, closest.on_a, velocity);
  const Doubles slope = dot(velocity, closest.axis);
  return select(of_a.goes, select(of_b.goes, slope * slope, of_a.square), of_b.square);
}

}  // namespace winnow::WINNOW_ISA_NAME::impact
