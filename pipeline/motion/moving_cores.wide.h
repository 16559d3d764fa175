#pragma once

// Cores of moving shapes, one per lane, all of one kind: loading, placement at a time, and support
// points. Used by all impact kernels of this folder.

#include "core/numbers/rotation.h"
#include "pipeline/kinds/with_shape.h"
#include "pipeline/motion/kind_lanes.wide.h"

namespace winnow::WINNOW_ISA_NAME::impact {

/// True for kinds that have a struct KindLanes. Pairs of other kinds go to the scalar search.
template <typename Shape>
inline constexpr bool kHasLanes = requires {
  sizeof(KindLanes<Shape>);
};
[[nodiscard]] constexpr bool has_lanes(ShapeKind kind) {
  return with_kind(kind, [](auto of) { return kHasLanes<typename decltype(of)::Shape>; });
}

/// Calls visit(KindLanes<Shape>) for a kind that has lanes, and returns its result.
template <typename Visit>
[[gnu::always_inline]] constexpr decltype(auto) with_core(ShapeKind kind, Visit&& visit) {
  return with_kind(
      kind, [&](auto of) __attribute__((always_inline))->decltype(auto) {
        using Shape = typename decltype(of)::Shape;
        if constexpr (kHasLanes<Shape>) {
          return visit(KindLanes<Shape>{});
        } else {
          return visit(KindLanes<HullShape>{});
        }
      });
}

[[nodiscard]] constexpr bool has_faces(ShapeKind kind) {
  return with_core(kind, [](auto core) { return decltype(core)::kHasFaces; });
}
[[nodiscard]] constexpr bool has_corners(ShapeKind kind) {
  return with_core(kind, [](auto core) { return decltype(core)::kHasCorners; });
}
/// Returns whether nearest_to supports a kind.
[[nodiscard]] constexpr bool has_nearest(ShapeKind kind) {
  return with_core(kind, [](auto core) {
    return requires(const MovingCore& placed, const Vector& p) {
      core.nearest(placed, p);
    };
  });
}

/// Support point of a core, in its own frame; for a half-space, the point of its plane along the
/// normal.
[[gnu::always_inline]] inline Vector farthest(const CoreTable& table, const MovingCore& core,
                                              const Vector& d, Mask16 lanes) {
  return with_core(
      table.kind, [&](auto kind) __attribute__((always_inline)) {
        return kind.farthest(table, core, d, lanes);
      });
}

/// The point of a core closest to `p`, which must be outside; both in the core's frame.
[[gnu::always_inline]] inline Vector nearest_to(const CoreTable& table, const MovingCore& core,
                                                const Vector& p) {
  return with_core(
      table.kind, [&](auto kind) __attribute__((always_inline))->Vector {
        if constexpr (requires { kind.nearest(core, p); }) {
          return kind.nearest(core, p);
        } else {
          return zero_vector();
        }
      });
}

/// Places a core at a time.
[[gnu::always_inline]] inline void place(const CoreTable& table, const Doubles& time,
                                         MovingCore& core) {
  if (!table.turns) return;
  core.axes = rotation_of(turned(core.from, core.axis, core.angle * time));
}

/// Loads the numbers of shapes; `index(lane)` is a shape's index in the table of its kind.
template <typename Index>
[[gnu::always_inline]] inline void load_core(const ShapeTables& tables, Index&& index,
                                             CoreTable& table, MovingCore& core) {
  core.half = zero_vector();
  core.rounding = Doubles(0.0);
  for (Vector& corner : core.corner) corner = zero_vector();
  with_core(
      table.kind, [&](auto kind)
                      __attribute__((always_inline)) { kind.load(tables, index, table, core); });
}

/// Computes the sizes of a core whose numbers are loaded.
static inline void measure(const CoreTable& table, MovingCore& core) {
  with_core(table.kind, [&](auto kind) { kind.measure(table, core); });
}

/// Rotates a triangle's corners to world axes; its frame is then the world.
inline void bring_to_world(MovingCore& core) {
  for (Vector& corner : core.corner) corner = core.axes.to_world(corner);
  const Doubles one(1.0);
  core.axes = rotation_of({one, zero_vector()});
}

/// Loads the rotation of a core whose sizes are computed, and its orientation at the start. Returns
/// the lanes in which this part of the motion is certainly valid and in the range of double.
template <typename Row>
[[gnu::always_inline]] inline DoubleMask load_turn(const CoreTable& table, Row&& motion,
                                                   MovingCore& core) {
  constexpr double kLongest = 1e200;
  constexpr double kMinAngle = 1e-100;
  const Doubles zero(0.0);
  const Doubles one(1.0);
  core.angle = core.reach = zero;
  Doubles q[4];
  load_rows4([&](int lane) { return motion(lane) + kOrientationAt; }, q);
  const Doubles square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  DoubleMask usable = (square > Doubles(1.0 / kLongest)) & (square < Doubles(kLongest));
  // A sphere's core does not rotate, but its body may, which is validated below.
  if (!table.turns && table.kind != ShapeKind::sphere) {
    core.axes = rotation(ScaledQuaternion<double>{q[0], {q[1], q[2], q[3]}, Doubles(2.0) / square});
    if (table.in_world) bring_to_world(core);
    return usable;
  }
  Doubles row[4];
  load_rows4([&](int lane) { return motion(lane) + kTurnAt - 1; }, row);
  const Vector about{row[1], row[2], row[3]};
  const Doubles turn = dot(about, about);
  usable = usable & (turn <= Doubles(RigidMotion::kMaxTurn * RigidMotion::kMaxTurn));
  if (!table.turns) return usable;
  const Doubles shrink = one / sqrt(square);
  const Orientation from{q[0] * shrink, Vector{q[1], q[2], q[3]} * shrink};
  core.from = from;
  const Doubles angle = sqrt(turn);
  const DoubleMask turns = angle > Doubles(kMinAngle);
  core.angle = select(turns, angle, zero);
  core.axis = select(turns, about * (one / angle), Vector{zero, zero, one});
  const Vector own = rotation_of(from).to_local(core.axis);
  if (table.kind == ShapeKind::hull) {
    measure_turning_hulls(table, own, core);
  } else {
    core.reach = with_core(table.kind, [&](auto kind) { return kind.reach(core, own); });
    core.low = dot(own, farthest(table, core, -own, kAllLanes<double>));
    core.high = dot(own, farthest(table, core, own, kAllLanes<double>));
  }
  core.reach = core.reach * Doubles(1.0 + kAxisError);
  return usable;
}

}  // namespace winnow::WINNOW_ISA_NAME::impact
