#pragma once

// The functions of each kind of shape that the impact kernels call, for one core per lane: its
// numbers, its support function, and bounds of its size and of its rotation. Called through
// with_core (moving_cores.wide.h).

#include "pipeline/motion/core_table.wide.h"

namespace winnow::WINNOW_ISA_NAME::impact {

/// Functions of a core by the struct of its shape. The members of each are:
///
///   load(tables, index, table, core)    loads the numbers; index(lane) is the index of a shape
///   measure(table, core)                computes `size` and `extent`
///   farthest(table, core, d, lanes)     support point in the frame of the core; for a half-space,
///                                       the point of its plane along the normal
///   reach(core, w)                      upper bound on the distance of points from the axis w
template <typename Shape>
struct KindLanes;

[[gnu::always_inline]] inline Doubles facing(const Doubles& along, const Doubles& reach) {
  return select(along < Doubles(0.0), -reach, reach);
}

/// Length of the part of an axis that is orthogonal to z.
[[gnu::always_inline]] inline Doubles across_z(const Vector& w) {
  return sqrt(w.x * w.x + w.y * w.y);
}

template <>
struct KindLanes<SphereShape> {
  template <typename Index>
  [[gnu::always_inline]] static void load(const ShapeTables& tables, Index&& index, CoreTable&,
                                          MovingCore& core) {
    core.rounding = load_rows1([&](int lane) { return numbers(tables.spheres[index(lane)]); });
  }
  [[gnu::always_inline]] static void measure(const CoreTable&, MovingCore& core) {
    core.size = length(core.half) + core.rounding;
    core.extent = core.size;
  }
  [[gnu::always_inline]] static Vector farthest(const CoreTable&, const MovingCore&, const Vector&,
                                                Mask16) {
    return zero_vector();
  }
  [[gnu::always_inline]] static Doubles reach(const MovingCore&, const Vector&) {
    return Doubles(0.0);
  }
};

template <>
struct KindLanes<CapsuleShape> : KindLanes<SphereShape> {
  template <typename Index>
  [[gnu::always_inline]] static void load(const ShapeTables& tables, Index&& index, CoreTable&,
                                          MovingCore& core) {
    Doubles r[2];
    load_rows2([&](int lane) { return numbers(tables.capsules[index(lane)]); }, r);
    core.rounding = r[0];
    core.half.z = r[1];
  }
  [[gnu::always_inline]] static Vector farthest(const CoreTable&, const MovingCore& core,
                                                const Vector& d, Mask16) {
    return {Doubles(0.0), Doubles(0.0), facing(d.z, core.half.z)};
  }
  [[gnu::always_inline]] static Doubles reach(const MovingCore& core, const Vector& w) {
    return core.half.z * across_z(w);
  }
};

template <>
struct KindLanes<BoxShape> : KindLanes<SphereShape> {
  template <typename Index>
  [[gnu::always_inline]] static void load(const ShapeTables& tables, Index&& index, CoreTable&,
                                          MovingCore& core) {
    Doubles r[4];
    load_rows4([&](int lane) { return numbers(tables.boxes[index(lane)]); }, r);
    core.half = {r[0], r[1], r[2]};
    core.rounding = r[3];
  }
  [[gnu::always_inline]] static Vector farthest(const CoreTable&, const MovingCore& core,
                                                const Vector& d, Mask16) {
    return {facing(d.x, core.half.x), facing(d.y, core.half.y), facing(d.z, core.half.z)};
  }
  [[gnu::always_inline]] static Doubles reach(const MovingCore& core, const Vector& w) {
    Doubles square(0.0);
    for (int corner = 0; corner < 4; ++corner) {
      const Vector v{core.half.x, (corner & 1) != 0 ? -core.half.y : core.half.y,
                     (corner & 2) != 0 ? -core.half.z : core.half.z};
      const Vector arm = cross(v, w);
      square = max(square, dot(arm, arm));
    }
    return sqrt(square);
  }
};

/// The support point on the rim of radius half.x about z.
[[gnu::always_inline]] inline Vector rim(const Vector& half, const Vector& d, const Doubles& z) {
  const Doubles across = sqrt(d.x * d.x + d.y * d.y);
  const Doubles share = select(across > Doubles(1e-150), half.x / across, Doubles(0.0));
  return {d.x * share, d.y * share, z};
}

/// The largest distance of a rim of `radius` at height z from an axis w through the centre.
[[gnu::always_inline]] inline Doubles rim_reach(const Doubles& radius, const Doubles& z,
                                                const Vector& w) {
  const Doubles across = sqrt(w.x * w.x + w.y * w.y);
  const Doubles nearest = positive_part(abs(z * w.z) - radius * across);
  return sqrt(positive_part(radius * radius + z * z - nearest * nearest));
}

/// A cylinder or cone, the numbers of which are its radius, its half length and its rounding.
template <typename Shape>
struct RevolvedKindLanes {
  template <typename Index>
  [[gnu::always_inline]] static void load(const ShapeTables& tables, Index&& index, CoreTable&,
                                          MovingCore& core) {
    const auto row = [&](int lane) { return numbers(KindOf<Shape>::in(tables)[index(lane)]); };
    Doubles r[2];
    load_rows2(row, r);
    core.half = {r[0], r[0], r[1]};
    core.rounding = load_rows1([&](int lane) { return row(lane) + 2; });
  }
  [[gnu::always_inline]] static void measure(const CoreTable&, MovingCore& core) {
    core.extent = sqrt(core.half.x * core.half.x + core.half.z * core.half.z) + core.rounding;
    core.size = core.extent;
  }
};

template <>
struct KindLanes<CylinderShape> : RevolvedKindLanes<CylinderShape> {
  [[gnu::always_inline]] static Vector farthest(const CoreTable&, const MovingCore& core,
                                                const Vector& d, Mask16) {
    return rim(core.half, d, facing(d.z, core.half.z));
  }
  [[gnu::always_inline]] static Doubles reach(const MovingCore& core, const Vector& w) {
    return rim_reach(core.half.x, core.half.z, w);
  }
};

template <>
struct KindLanes<ConeShape> : RevolvedKindLanes<ConeShape> {
  [[gnu::always_inline]] static Vector farthest(const CoreTable&, const MovingCore& core,
                                                const Vector& d, Mask16) {
    const Vector base = rim(core.half, d, -core.half.z);
    const Vector tip{Doubles(0.0), Doubles(0.0), core.half.z};
    return select(dot(tip, d) >= dot(base, d), tip, base);
  }
  [[gnu::always_inline]] static Doubles reach(const MovingCore& core, const Vector& w) {
    return max(rim_reach(core.half.x, -core.half.z, w), core.half.z * across_z(w));
  }
};

template <>
struct KindLanes<TriangleShape> {
  template <typename Index>
  [[gnu::always_inline]] static void load(const ShapeTables& tables, Index&& index, CoreTable&,
                                          MovingCore& core) {
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
  }
  [[gnu::always_inline]] static void measure(const CoreTable&, MovingCore& core) {
    Doubles size(0.0);
    Doubles side(0.0);
    for (int i = 0; i < 3; ++i) {
      size = max(size, length(core.corner[i]));
      side = max(side, length(core.corner[(i + 1) % 3] - core.corner[i]));
    }
    core.size = size + core.rounding;
    core.extent = side * Doubles(0.5) + core.rounding;
  }
  [[gnu::always_inline]] static Vector farthest(const CoreTable&, const MovingCore& core,
                                                const Vector& d, Mask16) {
    const Doubles on[3] = {dot(core.corner[0], d), dot(core.corner[1], d), dot(core.corner[2], d)};
    const DoubleMask is_first = (on[0] >= on[1]) & (on[0] >= on[2]);
    return select(is_first, core.corner[0], select(on[1] >= on[2], core.corner[1], core.corner[2]));
  }
  [[gnu::always_inline]] static Doubles reach(const MovingCore& core, const Vector& w) {
    Doubles square(0.0);
    for (const Vector& corner : core.corner) {
      const Vector arm = cross(corner, w);
      square = max(square, dot(arm, arm));
    }
    return sqrt(square);
  }
};

template <>
struct KindLanes<HalfSpaceShape> : KindLanes<SphereShape> {
  template <typename Index>
  [[gnu::always_inline]] static void load(const ShapeTables& tables, Index&& index, CoreTable&,
                                          MovingCore& core) {
    Doubles r[4];
    load_rows4([&](int lane) { return numbers(tables.half_spaces[index(lane)]); }, r);
    core.half = {r[0], r[1], r[2]};
    core.corner[0].x = r[3];
  }
  [[gnu::always_inline]] static void measure(const CoreTable&, MovingCore& core) {
    core.size = abs(core.corner[0].x);
    core.extent = Doubles(0.0);
  }
  [[gnu::always_inline]] static Vector farthest(const CoreTable&, const MovingCore& core,
                                                const Vector&, Mask16) {
    return core.half * core.corner[0].x;
  }
};

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

template <>
struct KindLanes<EllipsoidShape> {
  template <typename Index>
  [[gnu::always_inline]] static void load(const ShapeTables& tables, Index&& index, CoreTable&,
                                          MovingCore& core) {
    Doubles r[4];
    load_rows4([&](int lane) { return numbers(tables.ellipsoids[index(lane)]); }, r);
    core.half = {r[0], r[1], r[2]};
    core.rounding = r[3] + least_curvature_radius(core.half);
  }
  [[gnu::always_inline]] static void measure(const CoreTable&, MovingCore& core) {
    const Doubles most = max(max(core.half.x, core.half.y), core.half.z);
    core.extent = core.size = most - least_curvature_radius(core.half) + core.rounding;
  }
  [[gnu::always_inline]] static Vector farthest(const CoreTable&, const MovingCore& core,
                                                const Vector& d, Mask16) {
    return farthest_of_ellipsoid(core.half, d);
  }
  [[gnu::always_inline]] static Doubles reach(const MovingCore& core, const Vector&) {
    return core.extent - core.rounding;
  }
};

/// Support point of the convex hull of the smaller end's centre and a ball at the larger end's
/// centre. The radius of the ball is the difference of the radii.
static inline Vector farthest_of_taper(const Vector& half, const Vector& d) {
  const Doubles zero(0.0);
  const Vector out = d * (half.x / length(d));
  const Vector large{out.x, out.y, out.z + half.z};
  const Vector small{zero, zero, -half.z};
  return select(dot(small, d) >= dot(large, d), small, large);
}

template <>
struct KindLanes<TaperedCapsuleShape> {
  template <typename Index>
  [[gnu::always_inline]] static void load(const ShapeTables& tables, Index&& index, CoreTable&,
                                          MovingCore& core) {
    const auto row = [&](int lane) { return numbers(tables.tapered_capsules[index(lane)]); };
    Doubles r[2];
    load_rows2(row, r);
    const Doubles height = load_rows1([&](int lane) { return row(lane) + 2; });
    const Doubles excess = abs(r[1] - r[0]);
    core.half = {excess, excess, select(r[1] > r[0], height, -height)};
    core.rounding = min(r[0], r[1]);
  }
  [[gnu::always_inline]] static void measure(const CoreTable&, MovingCore& core) {
    core.extent = core.size = abs(core.half.z) + core.half.x + core.rounding;
  }
  [[gnu::always_inline]] static Vector farthest(const CoreTable&, const MovingCore& core,
                                                const Vector& d, Mask16) {
    return farthest_of_taper(core.half, d);
  }
  [[gnu::always_inline]] static Doubles reach(const MovingCore& core, const Vector& w) {
    return abs(core.half.z) * across_z(w) + core.half.x;
  }
};

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

template <>
struct KindLanes<SupportShape> {
  template <typename Index>
  [[gnu::always_inline]] static void load(const ShapeTables& tables, Index&& index,
                                          CoreTable& table, MovingCore& core) {
    for (int lane = 0; lane < kDoubleLanes; ++lane) {
      table.own[lane] = &tables.supports[index(lane)];
    }
    core.rounding = load_rows1([&](int lane) { return &table.own[lane]->rounding; });
  }
  [[gnu::always_inline]] static void measure(const CoreTable& table, MovingCore& core) {
    core.extent = load_rows1([&](int lane) { return &table.own[lane]->radius; }) + core.rounding;
    core.size = core.extent;
  }
  [[gnu::always_inline]] static Vector farthest(const CoreTable& table, const MovingCore&,
                                                const Vector& d, Mask16 lanes) {
    return farthest_of_user_shape(table, d, lanes);
  }
  [[gnu::always_inline]] static Doubles reach(const MovingCore& core, const Vector&) {
    return core.extent - core.rounding;
  }
};

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

template <>
struct KindLanes<HullShape> : KindLanes<SphereShape> {
  template <typename Index>
  [[gnu::always_inline]] static void load(const ShapeTables& tables, Index&& index,
                                          CoreTable& table, MovingCore& core) {
    for (int lane = 0; lane < kDoubleLanes; ++lane) {
      table.hull[lane] = &tables.hulls[index(lane)];
    }
    Doubles middle[4];
    load_rows4([&](int lane) { return table.hull[lane]->center; }, middle);
    core.half = {middle[0], middle[1], middle[2]};
    core.rounding = load_rows1([&](int lane) { return &table.hull[lane]->rounding; });
    copy_few_vertices(table);
  }
  [[gnu::always_inline]] static void measure(const CoreTable& table, MovingCore& core) {
    core.extent = load_rows1([&](int lane) { return &table.hull[lane]->radius; }) + core.rounding;
    core.size = norm_l1(core.half) + core.extent;
  }
  [[gnu::always_inline]] static Vector farthest(const CoreTable& table, const MovingCore&,
                                                const Vector& d, Mask16 lanes) {
    return table.rows > 0 ? farthest_of_few(table, d) : farthest_of_hulls(table, d, lanes);
  }
};

}  // namespace winnow::WINNOW_ISA_NAME::impact
