#pragma once

// The functions of each kind of shape that the impact kernels call, for one core per lane: its
// numbers, its support function, its closest points, the directions of its features, and bounds of
// its size and of its rotation. Called through with_core (moving_cores.wide.h).

#include "pipeline/kernels/round/ellipsoid_surface.wide.h"
#include "pipeline/kernels/round/round.wide.h"
#include "pipeline/motion/core_table.wide.h"

namespace winnow::WINNOW_ISA_NAME::impact {

/// Functions of a core by the struct of its shape. The members of each are:
///
///   load(tables, index, table, core)    loads the numbers; index(lane) is the index of a shape
///   measure(table, core)                computes `size` and `extent`
///   farthest(table, core, d, lanes)     support point in the frame of the core; for a half-space,
///                                       the point of its plane along the normal
///   reach(core, w)                      upper bound on the distance of points from the axis w
///   kHasFaces, kHasCorners              the core has flat faces; `corner` is in use
///
/// Some kinds also have:
///
///   height(core, d)          support of the placed core along d, faster than by `farthest`
///   nearest(core, p)         point of the core closest to a point outside, both in its frame
///   nearest_placed(core, p)  the same for a placed core, relative to its centre, in world axes
///   axes(core, axes)         directions of the faces and edges of the placed core
///   range(core, n, high, low)  support of the placed core along n and its opposite
template <typename Shape>
struct KindLanes;

/// Directions of the faces and edges of a core, in world axes, of any length; for round cores,
/// their axis.
struct CoreAxes {
  Vector normal[3];
  int normals;
  Vector edge[3];
  int edges;
};

[[gnu::always_inline]] inline Doubles facing(const Doubles& along, const Doubles& reach) {
  return select(along < Doubles(0.0), -reach, reach);
}

/// Length of the part of an axis that is orthogonal to z.
[[gnu::always_inline]] inline Doubles across_z(const Vector& w) {
  return sqrt(w.x * w.x + w.y * w.y);
}

struct PlainKindLanes {
  static constexpr bool kHasFaces = false;
  static constexpr bool kHasCorners = false;

  [[gnu::always_inline]] static void measure(const CoreTable&, MovingCore& core) {
    core.size = length(core.half) + core.rounding;
    core.extent = core.size;
  }
  [[gnu::always_inline]] static Doubles reach(const MovingCore&, const Vector&) {
    return Doubles(0.0);
  }
};

template <>
struct KindLanes<SphereShape> : PlainKindLanes {
  template <typename Index>
  [[gnu::always_inline]] static void load(const ShapeTables& tables, Index&& index, CoreTable&,
                                          MovingCore& core) {
    core.rounding = load_rows1([&](int lane) { return numbers(tables.spheres[index(lane)]); });
  }
  [[gnu::always_inline]] static Vector farthest(const CoreTable&, const MovingCore&, const Vector&,
                                                Mask16) {
    return zero_vector();
  }
  [[gnu::always_inline]] static Doubles height(const MovingCore&, const Vector&) {
    return Doubles(0.0);
  }
};

template <>
struct KindLanes<CapsuleShape> : PlainKindLanes {
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
  [[gnu::always_inline]] static Doubles height(const MovingCore& core, const Vector& d) {
    return abs(dot(d, core.axes.z)) * core.half.z;
  }
  static Vector nearest_placed(const MovingCore& core, const Vector& p) {
    return core.axes.z * round::clamp(dot(p, core.axes.z), -core.half.z, core.half.z);
  }
  static void axes(const MovingCore& core, CoreAxes& to) {
    to.normals = 0;
    to.edges = 1;
    to.edge[0] = core.axes.z;
  }
  [[gnu::always_inline]] static void range(const MovingCore& core, const Vector& n, Doubles& high,
                                           Doubles& low) {
    high = height(core, n);
    low = -high;
  }
};

template <>
struct KindLanes<BoxShape> : PlainKindLanes {
  static constexpr bool kHasFaces = true;

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
  [[gnu::always_inline]] static Doubles height(const MovingCore& core, const Vector& d) {
    return abs(dot(d, core.axes.x)) * core.half.x + abs(dot(d, core.axes.y)) * core.half.y +
           abs(dot(d, core.axes.z)) * core.half.z;
  }
  [[gnu::always_inline]] static Vector nearest(const MovingCore& core, const Vector& p) {
    return {round::clamp(p.x, -core.half.x, core.half.x),
            round::clamp(p.y, -core.half.y, core.half.y),
            round::clamp(p.z, -core.half.z, core.half.z)};
  }
  static void axes(const MovingCore& core, CoreAxes& to) {
    to.normals = to.edges = 3;
    to.normal[0] = to.edge[0] = core.axes.x;
    to.normal[1] = to.edge[1] = core.axes.y;
    to.normal[2] = to.edge[2] = core.axes.z;
  }
  [[gnu::always_inline]] static void range(const MovingCore& core, const Vector& n, Doubles& high,
                                           Doubles& low) {
    high = height(core, n);
    low = -high;
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

/// Coordinates in the half-plane of a point and an axis: the distance from the axis (>= 0), and the
/// position along it.
struct Meridian {
  Doubles away;
  Doubles z;
};

/// The closest point of a core that is round about its z axis; nearest(half, meridian) computes it
/// in the half-plane.
template <typename Nearest>
[[gnu::always_inline]] inline Vector nearest_of_revolved(const Vector& half, const Vector& p,
                                                         Nearest&& nearest_of) {
  const Meridian here{sqrt(p.x * p.x + p.y * p.y), p.z};
  const Meridian nearest = nearest_of(half, here);
  const Doubles share = select(here.away > Doubles(1e-150), nearest.away / here.away, Doubles(0.0));
  return {p.x * share, p.y * share, nearest.z};
}

[[gnu::always_inline]] inline Meridian nearest_of_cylinder(const Vector& half, const Meridian& p) {
  return {min(p.away, half.x), round::clamp(p.z, -half.z, half.z)};
}

/// The closest point of a cone's side or base.
[[gnu::always_inline]] inline Meridian nearest_of_cone(const Vector& half, const Meridian& p) {
  const Doubles zero(0.0);
  const Doubles one(1.0);
  const Doubles rise = half.z + half.z;
  // From the rim to the tip, the side moves inwards by half.x and up by `rise`.
  const Doubles square = half.x * half.x + rise * rise;
  const Doubles x = p.away - half.x;
  const Doubles y = p.z + half.z;
  const Doubles place = (y * rise - x * half.x) / select(square > zero, square, one);
  const Doubles share = max(min(place, one), zero);
  const Meridian side{half.x * (one - share), rise * share - half.z};
  const Meridian base{min(p.away, half.x), -half.z};
  const auto square_to = [&](const Meridian& q) {
    return (q.away - p.away) * (q.away - p.away) + (q.z - p.z) * (q.z - p.z);
  };
  const DoubleMask is_base = square_to(base) < square_to(side);
  return {select(is_base, base.away, side.away), select(is_base, base.z, side.z)};
}

/// A cylinder or cone, the numbers of which are its radius, its half length and its rounding.
template <typename Shape>
struct RevolvedKindLanes : PlainKindLanes {
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
  static void axes(const MovingCore& core, CoreAxes& to) {
    to.normals = to.edges = 1;
    to.normal[0] = to.edge[0] = core.axes.z;
  }

 protected:
  /// Support of the placed core's axis and of a rim, along n.
  struct Along {
    Doubles up;
    Doubles rim;
  };
  [[gnu::always_inline]] static Along along(const MovingCore& core, const Vector& n) {
    const Doubles on_axis = dot(n, core.axes.z);
    return {on_axis * core.half.z,
            core.half.x * sqrt(positive_part(dot(n, n) - on_axis * on_axis))};
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
  [[gnu::always_inline]] static Vector nearest(const MovingCore& core, const Vector& p) {
    return nearest_of_revolved(core.half, p, nearest_of_cylinder);
  }
  [[gnu::always_inline]] static void range(const MovingCore& core, const Vector& n, Doubles& high,
                                           Doubles& low) {
    const auto [up, rim] = along(core, n);
    high = abs(up) + rim;
    low = -high;
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
  [[gnu::always_inline]] static Vector nearest(const MovingCore& core, const Vector& p) {
    return nearest_of_revolved(core.half, p, nearest_of_cone);
  }
  [[gnu::always_inline]] static void range(const MovingCore& core, const Vector& n, Doubles& high,
                                           Doubles& low) {
    const auto [up, rim] = along(core, n);
    high = max(up, rim - up);
    low = min(up, -rim - up);
  }
};

/// The closest points of the segment s u, |s| <= half, of a and the triangle of b, in the frame of
/// b; `offset` is the vector from the segment's centre to the centre of b. If `is_point` is true,
/// the segment is a point.
static inline round::NearestCandidate<double> nearest_of_triangle(const MovingCore& b,
                                                                  const Vector& offset,
                                                                  const Vector& u,
                                                                  const Doubles& half,
                                                                  bool is_point) {
  const Doubles zero(0.0);
  const Doubles one(1.0);
  const TriangleLanes<double> triangle{{b.corner[0], b.corner[1], b.corner[2]}, b.rounding};
  const round::TriangleView<double> view = round::view_triangle(triangle, offset);
  round::NearestCandidate<double> nearest{zero_vector(), Doubles(__builtin_inf()), zero, zero};
  for (int i = 0; i < 3; ++i) {
    Doubles s = zero;
    Doubles t;
    if (is_point) {
      const Doubles place = -dot(view.vertex[i], view.edge[i]) / view.square[i];
      t = select(view.square[i] > zero, max(min(place, one), zero), zero);
    } else {
      const Vector across = cross(u, view.edge[i]);
      const auto feet =
          round::closest_feet(u, half, {view.vertex[i], view.edge[i], view.square[i], zero, one},
                              across, one / dot(across, across));
      s = feet.s;
      t = feet.t;
    }
    const Vector w = view.vertex[i] + view.edge[i] * t - u * s;
    round::nearer(nearest, zero < one, w, s, zero);
  }
  for (const Doubles& s : {-half, half}) {
    round::nearer_in_face(nearest, view, u * s, s);
    if (is_point) break;
  }
  return nearest;
}

template <>
struct KindLanes<TriangleShape> : PlainKindLanes {
  static constexpr bool kHasFaces = true;
  static constexpr bool kHasCorners = true;

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
  static Vector nearest_placed(const MovingCore& core, const Vector& p) {
    return p + nearest_of_triangle(core, -p, zero_vector(), Doubles(0.0), true).w;
  }
  static void axes(const MovingCore& core, CoreAxes& to) {
    to.edges = 3;
    for (int i = 0; i < 3; ++i) to.edge[i] = core.corner[(i + 1) % 3] - core.corner[i];
    to.normals = 1;
    to.normal[0] = cross(to.edge[0], to.edge[1]);
  }
  [[gnu::always_inline]] static void range(const MovingCore& core, const Vector& n, Doubles& high,
                                           Doubles& low) {
    const Doubles on[3] = {dot(n, core.corner[0]), dot(n, core.corner[1]), dot(n, core.corner[2])};
    high = max(max(on[0], on[1]), on[2]);
    low = min(min(on[0], on[1]), on[2]);
  }
};

template <>
struct KindLanes<HalfSpaceShape> : PlainKindLanes {
  static constexpr bool kHasCorners = true;

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

/// The closest point of an ellipsoid eroded by its least radius of curvature.
static inline Vector nearest_of_ellipsoid(const Vector& radius, const Vector& p) {
  const auto view = round::view_surface(radius, Vector{abs(p.x), abs(p.y), abs(p.z)});
  const auto facing = [](const Doubles& like, const Doubles& size) {
    return select(like < Doubles(0.0), -size, size);
  };
  const Vector& outward = view.outward;
  return farthest_of_ellipsoid(
      radius, {facing(p.x, outward.x), facing(p.y, outward.y), facing(p.z, outward.z)});
}

template <>
struct KindLanes<EllipsoidShape> : PlainKindLanes {
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
  [[gnu::always_inline]] static Vector nearest(const MovingCore& core, const Vector& p) {
    return nearest_of_ellipsoid(core.half, p);
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

/// Returns the closest point of the convex hull of a point and a ball. The ball is above the point
/// if half.z >= 0, else below. The normal of the conical side has the component `cosine` away from
/// the axis and `sine` along the axis, from the ball to the point. If p projects beyond an end of
/// the side, the closest point is the point or is on the ball.
[[gnu::always_inline]] inline Meridian nearest_of_taper(const Vector& half, const Meridian& p) {
  const Doubles zero(0.0);
  const Doubles one(1.0);
  const DoubleMask up = half.z >= zero;
  const Doubles height = abs(half.z);
  const Doubles z = select(up, p.z, -p.z);
  const Doubles length = height + height;
  const DoubleMask is_ball = half.x >= length;
  const Doubles sine = select(is_ball, zero, half.x / length);
  const Doubles cosine = sqrt((one - sine) * (one + sine));
  // Relative to the point.
  const Doubles over = z + height;
  const Doubles along = cosine * over + sine * p.away;
  const Doubles outside = cosine * p.away - sine * over;
  const DoubleMask low = (!is_ball) & (along <= zero);
  const DoubleMask side = (!is_ball) & (along > zero) & (along < cosine * length);
  const Doubles from_ball = sqrt(p.away * p.away + (z - height) * (z - height));
  const Doubles share = half.x / from_ball;
  const Doubles away = select(low, zero, select(side, p.away - outside * cosine, p.away * share));
  const Doubles at =
      select(low, -height, select(side, z + outside * sine, height + (z - height) * share));
  return {positive_part(away), select(up, at, -at)};
}

template <>
struct KindLanes<TaperedCapsuleShape> : PlainKindLanes {
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
  [[gnu::always_inline]] static Vector nearest(const MovingCore& core, const Vector& p) {
    return nearest_of_revolved(core.half, p, nearest_of_taper);
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
struct KindLanes<SupportShape> : PlainKindLanes {
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
struct KindLanes<HullShape> : PlainKindLanes {
  static constexpr bool kHasFaces = true;

  template <typename Index>
  [[gnu::always_inline]] static void load(const ShapeTables& tables, Index&& index,
                                          CoreTable& table, MovingCore& core) {
    for (int lane = 0; lane < kDoubleLanes; ++lane) {
      table.hull[lane] = &tables.hulls[index(lane)];
    }
    Doubles middle[4];
    load_rows4([&](int lane) { return table.hull[lane]->center.data(); }, middle);
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
