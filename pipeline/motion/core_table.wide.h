#pragma once

// A core of a moving shape in each lane, all of one kind, and its rotation about an axis through
// the body's position. kind_lanes.wide.h computes with it for each kind.

#include "core/numbers/rotation.h"
#include "pipeline/kernels/pair_lanes.wide.h"
#include "pipeline/kernels/user_support.wide.h"
#include "pipeline/motion/impact_lanes.kernel.h"

namespace winnow::WINNOW_ISA_NAME::impact {

using Vector = Vec3<double>;
using DoubleMask = LaneMask<double>;

inline constexpr int kDoubleLanes = Doubles::kCount;
/// The distance from 1 to the next double.
inline constexpr double kDoubleEpsilon = 0x1p-52;
/// Bound on the rounding error of a unit axis.
inline constexpr double kAxisError = 16.0 * kDoubleEpsilon;
/// In radians: hulls that rotate farther are measured by their vertices (measure_turning_hulls).
inline constexpr double kFarTurn = 2.0;
/// If no hull of a block has more vertices than this, the vertices of all hulls are copied to
/// lanes.
inline constexpr int kFewVertices = 2 * kDoubleLanes;

[[gnu::always_inline]] inline Vector zero_vector() {
  const Doubles zero(0.0);
  return {zero, zero, zero};
}
[[gnu::always_inline]] inline Doubles length(const Vector& v) {
  return sqrt(dot(v, v));
}
[[gnu::always_inline]] inline Doubles positive_part(const Doubles& v) {
  return max(v, Doubles(0.0));
}
[[gnu::always_inline]] inline Doubles one_where(const DoubleMask& mask) {
  return select(mask, Doubles(1.0), Doubles(0.0));
}

/// Rounds to the nearest integer; |v| must be below 2^51.
[[gnu::always_inline]] inline Doubles nearest_whole(const Doubles& v) {
  const Doubles shift(0x1.8p52);
  return (v + shift) - shift;
}

struct SineCosineLanes {
  Doubles sine;
  Doubles cosine;
};

/// Equal to impact::sine_cosine in every bit.
[[gnu::always_inline]] inline SineCosineLanes sine_cosine(const Doubles& angle) {
  const Doubles quarters = nearest_whole(angle * Doubles(6.36619772367581382433e-01));
  const Doubles x = (angle - quarters * Doubles(1.57079632673412561417e+00)) -
                    quarters * Doubles(6.07710050650619224932e-11);
  const Doubles z = x * x;
  Doubles sine(-1.0 / 1307674368000.0);
  for (const double term : {1.0 / 6227020800.0, -1.0 / 39916800.0, 1.0 / 362880.0, -1.0 / 5040.0,
                            1.0 / 120.0, -1.0 / 6.0}) {
    sine = sine * z + Doubles(term);
  }
  sine = x + x * (z * sine);
  Doubles cosine(1.0 / 20922789888000.0);
  for (const double term : {-1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0,
                            1.0 / 40320.0, -1.0 / 720.0, 1.0 / 24.0, -0.5}) {
    cosine = cosine * z + Doubles(term);
  }
  cosine = Doubles(1.0) + z * cosine;
  // For a multiple of 1/4 this rounds down to an integer.
  const Doubles turns = nearest_whole(quarters * Doubles(0.25) - Doubles(0.375));
  const Doubles quarter = quarters - turns * Doubles(4.0);
  const DoubleMask back = quarter > Doubles(1.5);
  const DoubleMask odd = (quarter == Doubles(1.0)) | (quarter == Doubles(3.0));
  const Doubles s = select(odd, cosine, sine);
  const Doubles c = select(odd, -sine, cosine);
  return {select(back, -s, s), select(back, -c, c)};
}

/// A quaternion of length 1, up to rounding.
struct Orientation {
  Doubles w;
  Vector v;
};

/// An orientation rotated about a unit axis by an angle.
[[gnu::always_inline]] inline Orientation turned(const Orientation& from, const Vector& axis,
                                                 const Doubles& angle) {
  const SineCosineLanes half = sine_cosine(angle * Doubles(0.5));
  const Vector u = axis * half.sine;
  return {half.cosine * from.w - dot(u, from.v),
          from.v * half.cosine + u * from.w + cross(u, from.v)};
}

[[gnu::always_inline]] inline Rotation<double> rotation_of(const Orientation& q) {
  return rotation(ScaledQuaternion<double>{q.w, q.v, Doubles(2.0)});
}

/// Offsets of the members of RigidMotion, in doubles.
inline constexpr int kOrientationAt = 3;
inline constexpr int kTravelAt = 7;
inline constexpr int kTurnAt = 10;
static_assert(sizeof(RigidMotion) == 13 * sizeof(double));

/// A core and the rotation of its body. All members are lanes of double, so that a block can copy a
/// lane as an array of numbers.
struct MovingCore {
  /// For cores that rotate: the orientation at the start, the unit axis of rotation, and the range
  /// of the core's points along it.
  Orientation from;
  Vector axis;
  Doubles low;
  Doubles high;
  /// The total angle in radians, and an upper bound on the distance of points from the axis; both
  /// are 0 for cores that do not rotate.
  Doubles angle;
  Doubles reach;
  /// By kind: half extents (box); 0, 0, half length (capsule); radius, radius, half length
  /// (cylinder, cone); centre (hull); radii (ellipsoid); the difference of the radii, twice, and
  /// the height of the larger ball's centre (tapered capsule); normal (half-space).
  Vector half;
  Doubles rounding;
  /// Upper bound on the distance of the shape's points from the body's position.
  Doubles size;
  /// Corners of a triangle; for a half-space, the first number is its offset.
  Vector corner[3];
  /// Rotation from the core's frame to the world, at the time at which the core is placed.
  Rotation<double> axes;
  /// The size that tolerances are relative to.
  Doubles extent;
};

/// The members of a core that are not lanes.
struct CoreTable {
  ShapeKind kind;
  /// The axes of the core's frame are the axes of the world.
  bool in_world;
  /// Whether the core rotates: never for spheres, for half-spaces only in jobs of
  /// ImpactMotion::plane_turns.
  bool turns;
  const HullShape* hull[kDoubleLanes];
  const SupportShape* own[kDoubleLanes];
  /// If no hull has more than kFewVertices vertices: the number of vertex rows, of which the last
  /// may repeat vertices. Else 0.
  int rows;
  alignas(64) double vertex[kFewVertices][3][kDoubleLanes];
};

/// Copies the vertices of a lane's hull to `rows` rows.
inline void copy_vertices(CoreTable& table, unsigned lane) {
  const HullShape& hull = *table.hull[lane];
  for (int row = 0; row < table.rows; ++row) {
    const int i = row < static_cast<int>(hull.vertex_count) ? row : 0;
    for (int k = 0; k < 3; ++k) table.vertex[row][k][lane] = hull.vertex[k][i];
  }
}

}  // namespace winnow::WINNOW_ISA_NAME::impact
