#pragma once

// Cores of moving shapes, one per lane, all of one kind: their numbers, their rotation about an
// axis through the body's position, their placement at a time, and their support functions. Used by
// all impact kernels of this folder.

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

[[nodiscard]] constexpr bool has_corners(ShapeKind kind) {
  return kind == ShapeKind::triangle || kind == ShapeKind::half_space;
}

[[nodiscard]] constexpr bool has_faces(ShapeKind kind) {
  return kind == ShapeKind::box || kind == ShapeKind::hull || kind == ShapeKind::triangle;
}

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

/// Copies the vertices of all lanes, if no hull has more than kFewVertices.
static inline void copy_few_vertices(CoreTable& table) {
  std::uint32_t most = 0;
  for (const HullShape* hull : table.hull) {
    most = hull->vertex_count > most ? hull->vertex_count : most;
  }
  table.rows = most > kFewVertices ? 0 : most > kDoubleLanes ? kFewVertices : kDoubleLanes;
  for (int k = 0; k < 3; ++k) {
    for (int row = 0; row < table.rows; row += 4) {
      const double* from[kDoubleLanes];
      for (int lane = 0; lane < kDoubleLanes; ++lane) {
        const HullShape& hull = *table.hull[lane];
        // Padding to a multiple of kDoubleLanes repeats vertex 0.
        const bool has = (row & kDoubleLanes) < static_cast<int>(hull.vertex_count);
        from[lane] = hull.vertex[k] + (has ? row : 0);
      }
      Doubles four[4];
      load_rows4([&](int lane) { return from[lane]; }, four);
      for (int i = 0; i < 4; ++i) four[i].store(table.vertex[row + i][k]);
    }
  }
}

/// Support point of each lane's hull, for hulls of few vertices, in the hull's frame. Breaks ties
/// as farthest_of_hulls does.
static inline Vector farthest_of_few(const CoreTable& table, const Vector& d) {
  Doubles most(-__builtin_inf());
  Vector point = zero_vector();
  for (int place = 0; place < kDoubleLanes; ++place) {
    for (int row = place; row < table.rows; row += kDoubleLanes) {
      const Vector v{Doubles::load(table.vertex[row][0]), Doubles::load(table.vertex[row][1]),
                     Doubles::load(table.vertex[row][2])};
      const Doubles value = v.x * d.x + v.y * d.y + v.z * d.z;
      const DoubleMask higher = value > most;
      most = select(higher, value, most);
      point = select(higher, v, point);
    }
  }
  return point;
}

/// Support point of each lane's hull, in the hull's frame.
static inline Vector farthest_of_hulls(const CoreTable& table, const Vector& direction,
                                       Mask16 lanes) {
  alignas(64) double d[3][kDoubleLanes];
  alignas(64) double best[kDoubleLanes][kDoubleLanes];
  alignas(64) double where[kDoubleLanes][kDoubleLanes];
  if (lanes != kAllLanes<double>) {
    for (int lane = 0; lane < kDoubleLanes; ++lane) {
      Doubles(0.0).store(best[lane]);
      Doubles(0.0).store(where[lane]);
    }
  }
  direction.x.store(d[0]);
  direction.y.store(d[1]);
  direction.z.store(d[2]);
  alignas(64) static constexpr double kSteps[kDoubleLanes] = {0, 1, 2, 3, 4, 5, 6, 7};
  const Doubles steps = Doubles::load(kSteps);
  for (Mask16 rest = lanes; rest != 0; rest &= rest - 1) {
    const unsigned lane = first(rest);
    const HullShape& hull = *table.hull[lane];
    const Doubles x(d[0][lane]);
    const Doubles y(d[1][lane]);
    const Doubles z(d[2][lane]);
    Doubles most(-__builtin_inf());
    Doubles at = steps;
    Doubles here = steps;
    for (std::uint32_t row = 0; row < hull.vertex_count; row += kDoubleLanes) {
      const Doubles value = Doubles::load(hull.vertex[0] + row) * x +
                            Doubles::load(hull.vertex[1] + row) * y +
                            Doubles::load(hull.vertex[2] + row) * z;
      const DoubleMask higher = value > most;
      most = select(higher, value, most);
      at = select(higher, here, at);
      here += Doubles(kDoubleLanes);
    }
    most.store(best[lane]);
    at.store(where[lane]);
  }
  Doubles value[kDoubleLanes];
  Doubles index[kDoubleLanes];
  for (int half = 0; half < 2; ++half) {
    Doubles four[4];
    load_rows4([&](int lane) { return best[lane] + 4 * half; }, four);
    for (int k = 0; k < 4; ++k) value[4 * half + k] = four[k];
    load_rows4([&](int lane) { return where[lane] + 4 * half; }, four);
    for (int k = 0; k < 4; ++k) index[4 * half + k] = four[k];
  }
  for (int k = 1; k < kDoubleLanes; ++k) {
    const DoubleMask higher = value[k] > value[0];
    value[0] = select(higher, value[k], value[0]);
    index[0] = select(higher, index[k], index[0]);
  }
  alignas(64) double number[kDoubleLanes];
  alignas(64) double vertex[3][kDoubleLanes] = {};
  index[0].store(number);
  for (Mask16 rest = lanes; rest != 0; rest &= rest - 1) {
    const unsigned lane = first(rest);
    const HullShape& hull = *table.hull[lane];
    const auto named = static_cast<std::uint32_t>(number[lane]);
    // Padding repeats vertex 0.
    const std::uint32_t i = named < hull.vertex_count ? named : 0;
    for (int k = 0; k < 3; ++k) vertex[k][lane] = hull.vertex[k][i];
  }
  return {Doubles::load(vertex[0]), Doubles::load(vertex[1]), Doubles::load(vertex[2])};
}

/// Support point of each lane's user shape.
static inline Vector farthest_of_user_shape(const CoreTable& table, const Vector& direction,
                                            Mask16 lanes) {
  alignas(64) double d[3][kDoubleLanes];
  alignas(64) double point[3][kDoubleLanes] = {};
  const Doubles size = length(direction);
  const DoubleMask has_size = size > Doubles(0.0);
  select(has_size, direction.x / size, Doubles(1.0)).store(d[0]);
  select(has_size, direction.y / size, Doubles(0.0)).store(d[1]);
  select(has_size, direction.z / size, Doubles(0.0)).store(d[2]);
  for (; lanes != 0; lanes &= lanes - 1) {
    const unsigned lane = first(lanes);
    const double along[3] = {d[0][lane], d[1][lane], d[2][lane]};
    double x[3];
    user_point(*table.own[lane], along, x);
    for (int k = 0; k < 3; ++k) point[k][lane] = x[k];
  }
  return {Doubles::load(point[0]), Doubles::load(point[1]), Doubles::load(point[2])};
}

/// The support point on the rim of radius half.x about z.
[[gnu::always_inline]] inline Vector rim(const Vector& half, const Vector& d, const Doubles& z) {
  const Doubles across = sqrt(d.x * d.x + d.y * d.y);
  const Doubles share = select(across > Doubles(1e-150), half.x / across, Doubles(0.0));
  return {d.x * share, d.y * share, z};
}

[[gnu::always_inline]] inline Vector farthest_of_corners(const MovingCore& core, const Vector& d) {
  const Doubles on[3] = {dot(core.corner[0], d), dot(core.corner[1], d), dot(core.corner[2], d)};
  const DoubleMask is_first = (on[0] >= on[1]) & (on[0] >= on[2]);
  return select(is_first, core.corner[0], select(on[1] >= on[2], core.corner[1], core.corner[2]));
}

/// The least radius of curvature of an ellipsoid; 0 for a flat one.
[[gnu::always_inline]] inline Doubles least_curvature_radius(const Vector& radius) {
  const Doubles least = min(min(radius.x, radius.y), radius.z);
  const Doubles most = max(max(radius.x, radius.y), radius.z);
  return least * select(most > Doubles(0.0), least / most, Doubles(0.0));
}

/// Support point of an ellipsoid eroded by its least radius of curvature; see eroded_core.
static inline Vector farthest_of_ellipsoid(const Vector& radius, const Vector& d) {
  const Vector stretched{radius.x * d.x, radius.y * d.y, radius.z * d.z};
  const Doubles along = length(stretched);
  const Doubles share = select(along > Doubles(1e-150), Doubles(1.0) / along, Doubles(0.0));
  const Vector eroded = d * (least_curvature_radius(radius) / length(d));
  return Vector{radius.x * stretched.x, radius.y * stretched.y, radius.z * stretched.z} * share -
         eroded;
}

/// Support point of the convex hull of the smaller end's centre and a ball at the larger end's
/// centre. The radius of the ball is the difference of the radii.
static inline Vector farthest_of_taper(const Vector& half, const Vector& d) {
  const Doubles zero(0.0);
  const Vector out = d * (half.x / length(d));
  const Vector large{out.x, out.y, out.z + half.z};
  const Vector small{zero, zero, -half.z};
  return select(dot(small, d) >= dot(large, d), small, large);
}

/// Support point of a core, in its own frame; for a half-space, the point of its plane along the
/// normal.
[[gnu::always_inline]] inline Vector farthest(const CoreTable& table, const MovingCore& core,
                                              const Vector& d, Mask16 lanes) {
  const auto facing = [](const Doubles& along, const Doubles& reach) {
    return select(along < Doubles(0.0), -reach, reach);
  };
  switch (table.kind) {
    case ShapeKind::sphere:
      return zero_vector();
    case ShapeKind::capsule:
      return {Doubles(0.0), Doubles(0.0), facing(d.z, core.half.z)};
    case ShapeKind::box:
      return {facing(d.x, core.half.x), facing(d.y, core.half.y), facing(d.z, core.half.z)};
    case ShapeKind::cylinder:
      return rim(core.half, d, facing(d.z, core.half.z));
    case ShapeKind::cone: {
      const Vector base = rim(core.half, d, -core.half.z);
      const Vector tip{Doubles(0.0), Doubles(0.0), core.half.z};
      return select(dot(tip, d) >= dot(base, d), tip, base);
    }
    case ShapeKind::triangle:
      return farthest_of_corners(core, d);
    case ShapeKind::half_space:
      return core.half * core.corner[0].x;
    case ShapeKind::ellipsoid:
      return farthest_of_ellipsoid(core.half, d);
    case ShapeKind::tapered_capsule:
      return farthest_of_taper(core.half, d);
    case ShapeKind::support:
      return farthest_of_user_shape(table, d, lanes);
    default:
      return table.rows > 0 ? farthest_of_few(table, d) : farthest_of_hulls(table, d, lanes);
  }
}

/// Places a core at a time.
[[gnu::always_inline]] inline void place(const CoreTable& table, const Doubles& time,
                                         MovingCore& core) {
  if (!table.turns) return;
  core.axes = rotation_of(turned(core.from, core.axis, core.angle * time));
}

/// The largest distance of a rim of `radius` at height z from an axis w through the centre.
[[gnu::always_inline]] inline Doubles rim_reach(const Doubles& radius, const Doubles& z,
                                                const Vector& w) {
  const Doubles across = sqrt(w.x * w.x + w.y * w.y);
  const Doubles nearest = positive_part(abs(z * w.z) - radius * across);
  return sqrt(positive_part(radius * radius + z * z - nearest * nearest));
}

[[gnu::always_inline]] inline Doubles box_reach(const Vector& half, const Vector& w) {
  Doubles square(0.0);
  for (int corner = 0; corner < 4; ++corner) {
    const Vector v{half.x, (corner & 1) != 0 ? -half.y : half.y,
                   (corner & 2) != 0 ? -half.z : half.z};
    const Vector arm = cross(v, w);
    square = max(square, dot(arm, arm));
  }
  return sqrt(square);
}

/// Returns an upper bound on the distance of a core's points from the axis w, in the frame of the
/// core.
static inline Doubles reach_of(const CoreTable& table, const MovingCore& core, const Vector& w) {
  switch (table.kind) {
    case ShapeKind::sphere:
      return Doubles(0.0);
    case ShapeKind::capsule:
      return core.half.z * sqrt(w.x * w.x + w.y * w.y);
    case ShapeKind::box:
      return box_reach(core.half, w);
    case ShapeKind::cylinder:
      return rim_reach(core.half.x, core.half.z, w);
    case ShapeKind::cone:
      return max(rim_reach(core.half.x, -core.half.z, w),
                 core.half.z * sqrt(w.x * w.x + w.y * w.y));
    case ShapeKind::triangle: {
      Doubles square(0.0);
      for (const Vector& corner : core.corner) {
        const Vector arm = cross(corner, w);
        square = max(square, dot(arm, arm));
      }
      return sqrt(square);
    }
    case ShapeKind::ellipsoid:
    case ShapeKind::support:
      return core.extent - core.rounding;
    case ShapeKind::tapered_capsule:
      return abs(core.half.z) * sqrt(w.x * w.x + w.y * w.y) + core.half.x;
    default:
      return Doubles(0.0);
  }
}

/// The maximum of each row; row i belongs to lane i.
static inline Doubles greatest_of_rows(const double (&row)[kDoubleLanes][kDoubleLanes]) {
  Doubles most(-__builtin_inf());
  for (int half = 0; half < kDoubleLanes; half += 4) {
    Doubles four[4];
    load_rows4([&](int lane) { return row[lane] + half; }, four);
    for (const Doubles& values : four) most = max(most, values);
  }
  return most;
}

/// Computes the reach of hulls, as reach_of does for other cores, and their range along the axis:
/// by the bounding ball about the centre or, if a hull rotates by more than kFarTurn, by the
/// vertices.
static inline void measure_turning_hulls(const CoreTable& table, const Vector& w,
                                         MovingCore& core) {
  const Doubles radius = core.extent - core.rounding;
  const Doubles height = dot(core.half, w);
  core.reach = length(cross(core.half, w)) + radius;
  core.low = height - radius;
  core.high = height + radius;
  const DoubleMask far = core.angle > Doubles(kFarTurn);
  if (bits(far) == 0) return;
  alignas(64) double axis[3][kDoubleLanes];
  alignas(64) double found[3][kDoubleLanes][kDoubleLanes] = {};
  w.x.store(axis[0]);
  w.y.store(axis[1]);
  w.z.store(axis[2]);
  for (Mask16 lanes = bits(far); lanes != 0; lanes &= lanes - 1) {
    const unsigned lane = first(lanes);
    const HullShape& hull = *table.hull[lane];
    const Vector about{Doubles(axis[0][lane]), Doubles(axis[1][lane]), Doubles(axis[2][lane])};
    Doubles square(0.0);
    Doubles high(-__builtin_inf());
    Doubles low(-__builtin_inf());
    // Padding repeats vertex 0.
    for (std::uint32_t row = 0; row < hull.vertex_count; row += kDoubleLanes) {
      const Vector v{Doubles::load(hull.vertex[0] + row), Doubles::load(hull.vertex[1] + row),
                     Doubles::load(hull.vertex[2] + row)};
      const Vector arm = cross(v, about);
      const Doubles along = dot(v, about);
      square = max(square, dot(arm, arm));
      high = max(high, along);
      low = max(low, -along);
    }
    square.store(found[0][lane]);
    high.store(found[1][lane]);
    low.store(found[2][lane]);
  }
  core.reach = select(far, sqrt(greatest_of_rows(found[0])), core.reach);
  core.high = select(far, greatest_of_rows(found[1]), core.high);
  core.low = select(far, -greatest_of_rows(found[2]), core.low);
}

/// Loads the numbers of shapes; `index(lane)` is a shape's index in the table of its kind.
template <typename Index>
[[gnu::always_inline]] inline void load_core(const ShapeTables& tables, Index&& index,
                                             CoreTable& table, MovingCore& core) {
  const Doubles zero(0.0);
  core.half = zero_vector();
  core.rounding = zero;
  for (Vector& corner : core.corner) corner = zero_vector();
  switch (table.kind) {
    case ShapeKind::sphere:
      core.rounding = load_rows1([&](int lane) { return numbers(tables.spheres[index(lane)]); });
      break;
    case ShapeKind::capsule: {
      Doubles r[2];
      load_rows2([&](int lane) { return numbers(tables.capsules[index(lane)]); }, r);
      core.rounding = r[0];
      core.half.z = r[1];
      break;
    }
    case ShapeKind::box: {
      Doubles r[4];
      load_rows4([&](int lane) { return numbers(tables.boxes[index(lane)]); }, r);
      core.half = {r[0], r[1], r[2]};
      core.rounding = r[3];
      break;
    }
    case ShapeKind::cylinder:
    case ShapeKind::cone: {
      const auto row = [&](int lane) {
        return table.kind == ShapeKind::cone ? numbers(tables.cones[index(lane)])
                                             : numbers(tables.cylinders[index(lane)]);
      };
      Doubles r[2];
      load_rows2(row, r);
      core.half = {r[0], r[0], r[1]};
      core.rounding = load_rows1([&](int lane) { return row(lane) + 2; });
      break;
    }
    case ShapeKind::triangle: {
      const auto row = [&](int lane) { return numbers(tables.triangles[index(lane)]); };
      Doubles r[10];
      for (int part = 0; part < 2; ++part) {
        Doubles four[4];
        load_rows4([&](int lane) { return row(lane) + 4 * part; }, four);
        for (int k = 0; k < 4; ++k) r[4 * part + k] = four[k];
      }
      Doubles two[2];
      load_rows2([&](int lane) { return row(lane) + 8; }, two);
      core.corner[0] = {r[0], r[1], r[2]};
      core.corner[1] = {r[3], r[4], r[5]};
      core.corner[2] = {r[6], r[7], two[0]};
      core.rounding = two[1];
      break;
    }
    case ShapeKind::half_space: {
      Doubles r[4];
      load_rows4([&](int lane) { return numbers(tables.half_spaces[index(lane)]); }, r);
      core.half = {r[0], r[1], r[2]};
      core.corner[0].x = r[3];
      break;
    }
    case ShapeKind::ellipsoid: {
      Doubles r[4];
      load_rows4([&](int lane) { return numbers(tables.ellipsoids[index(lane)]); }, r);
      core.half = {r[0], r[1], r[2]};
      core.rounding = r[3] + least_curvature_radius(core.half);
      break;
    }
    case ShapeKind::tapered_capsule: {
      const auto row = [&](int lane) { return numbers(tables.tapered_capsules[index(lane)]); };
      Doubles r[2];
      load_rows2(row, r);
      const Doubles height = load_rows1([&](int lane) { return row(lane) + 2; });
      const Doubles excess = abs(r[1] - r[0]);
      core.half = {excess, excess, select(r[1] > r[0], height, -height)};
      core.rounding = min(r[0], r[1]);
      break;
    }
    case ShapeKind::support: {
      for (int lane = 0; lane < kDoubleLanes; ++lane) {
        table.own[lane] = &tables.supports[index(lane)];
      }
      core.rounding = load_rows1([&](int lane) { return &table.own[lane]->rounding; });
      break;
    }
    default: {
      for (int lane = 0; lane < kDoubleLanes; ++lane) {
        table.hull[lane] = &tables.hulls[index(lane)];
      }
      Doubles middle[4];
      load_rows4([&](int lane) { return table.hull[lane]->center; }, middle);
      core.half = {middle[0], middle[1], middle[2]};
      core.rounding = load_rows1([&](int lane) { return &table.hull[lane]->rounding; });
      copy_few_vertices(table);
      break;
    }
  }
}

/// Computes the sizes of a core whose numbers are loaded.
static inline void measure(const CoreTable& table, MovingCore& core) {
  if (table.kind == ShapeKind::triangle) {
    Doubles size(0.0);
    Doubles side(0.0);
    for (int i = 0; i < 3; ++i) {
      size = max(size, length(core.corner[i]));
      side = max(side, length(core.corner[(i + 1) % 3] - core.corner[i]));
    }
    core.size = size + core.rounding;
    core.extent = side * Doubles(0.5) + core.rounding;
  } else if (table.kind == ShapeKind::hull) {
    core.extent = load_rows1([&](int lane) { return &table.hull[lane]->radius; }) + core.rounding;
    core.size = norm_l1(core.half) + core.extent;
  } else if (table.kind == ShapeKind::cylinder || table.kind == ShapeKind::cone) {
    core.extent = sqrt(core.half.x * core.half.x + core.half.z * core.half.z) + core.rounding;
    core.size = core.extent;
  } else if (table.kind == ShapeKind::ellipsoid) {
    const Doubles most = max(max(core.half.x, core.half.y), core.half.z);
    core.extent = core.size = most - least_curvature_radius(core.half) + core.rounding;
  } else if (table.kind == ShapeKind::tapered_capsule) {
    core.extent = core.size = abs(core.half.z) + core.half.x + core.rounding;
  } else if (table.kind == ShapeKind::support) {
    core.extent = load_rows1([&](int lane) { return &table.own[lane]->radius; }) + core.rounding;
    core.size = core.extent;
  } else if (table.kind == ShapeKind::half_space) {
    core.size = abs(core.corner[0].x);
    core.extent = Doubles(0.0);
  } else {
    core.size = length(core.half) + core.rounding;
    core.extent = core.size;
  }
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
    core.reach = reach_of(table, core, own);
    core.low = dot(own, farthest(table, core, -own, kAllLanes<double>));
    core.high = dot(own, farthest(table, core, own, kAllLanes<double>));
  }
  core.reach = core.reach * Doubles(1.0 + kAxisError);
  return usable;
}

}  // namespace winnow::WINNOW_ISA_NAME::impact
