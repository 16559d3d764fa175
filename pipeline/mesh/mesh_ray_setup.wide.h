#pragma once

// Rays into the frame of a surface, and made ready for their way through the nodes of a mesh: eight
// at once, a lane for each, or one alone in plain numbers, which have less to wait for than lanes
// of axes. In double, without fused operations: the same either way and on every instruction set.

#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_traversal.h"
#include "simd/lanes/float_axes.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// In the units of the nodes: more than float makes of a bound on its way to tau.
inline constexpr double kUnitDoubt = 0.05;
/// A ray that moves by fewer units for each tau stands on that axis: its way through the mesh takes
/// it less than kUnitDoubt.
inline constexpr double kStandingRate = 0.01;
inline constexpr double kStandingInverse = 1e30;
/// More slack than this leaves all in doubt as well.
inline constexpr double kMostSlack = 1e200;

// Of a ray that is measured from where it begins, in float: u is half an ulp of 1.

/// It begins no more units away along any axis, so that it leaves the mesh before tau = 200.
inline constexpr float kNearUnits = 0x1p22F;
/// What roundings make of its place and of its way to a bound, as a share of where it is, and of
/// the largest bound: 32 u, where 12 are met, or 24 in a mode that rounds to one side.
inline constexpr float kNearShare = 0x1p-19F;
inline constexpr float kNearDoubt = 0.5F;

/// Three numbers of one vector.
struct Numbers {
  double x;
  double y;
  double z;

  [[gnu::always_inline]] friend Numbers operator+(const Numbers& a, const Numbers& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  [[gnu::always_inline]] friend Numbers operator-(const Numbers& a, const Numbers& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  [[gnu::always_inline]] friend Numbers operator*(const Numbers& a, double s) {
    return {a.x * s, a.y * s, a.z * s};
  }
};

/// Eight rays.
struct RaysInLanes {
  static constexpr std::uint32_t kRoom = kRaysAtOnce;
  using Number = Doubles;
  using Vector = Vec3<double>;
};
/// One ray.
struct RayInNumbers {
  static constexpr std::uint32_t kRoom = 1;
  using Number = double;
  using Vector = Numbers;
};

// What both are written in.

[[gnu::always_inline]] inline void load(const double* p, double& number) {
  number = *p;
}
[[gnu::always_inline]] inline void load(const double* p, Doubles& number) {
  number = Doubles::load(p);
}
[[gnu::always_inline]] inline void store(double number, double* p) {
  *p = number;
}
[[gnu::always_inline]] inline void store(const Doubles& number, double* p) {
  number.store(p);
}
[[gnu::always_inline]] inline void store(double number, float* p) {
  *p = static_cast<float>(number);
}
[[gnu::always_inline]] inline void store(const Doubles& number, float* p) {
  to_single(number).store_unaligned(p);
}
[[gnu::always_inline]] inline Mask16 bits(bool holds) {
  return holds ? 1U : 0U;
}
[[gnu::always_inline]] inline double select(bool holds, double a, double b) {
  return holds ? a : b;
}
[[gnu::always_inline]] inline double abs(double a) {
  return __builtin_fabs(a);
}
[[gnu::always_inline]] inline double min(double a, double b) {
  return a < b ? a : b;
}
[[gnu::always_inline]] inline double max(double a, double b) {
  return a > b ? a : b;
}
/// With the sign of another one; none of its own is set.
[[gnu::always_inline]] inline double with_sign(double size, double of) {
  return __builtin_copysign(size, of);
}
[[gnu::always_inline]] inline Doubles with_sign(const Doubles& size, const Doubles& of) {
  return (of & Doubles(-0.0)) | size;
}
/// The power of two of its exponent. Infinity has the bits of the exponent alone.
[[gnu::always_inline]] inline Doubles power_of(const Doubles& v) {
  return v & Doubles(__builtin_inf());
}

template <typename Vector, std::size_t Room>
[[gnu::always_inline]] inline Vector load(const double (&column)[3][Room], std::uint32_t first) {
  Vector v;
  load(column[0] + first, v.x);
  load(column[1] + first, v.y);
  load(column[2] + first, v.z);
  return v;
}
template <typename Vector, typename T, std::size_t Rows, std::size_t Room>
[[gnu::always_inline]] inline void store(const Vector& v, T (&column)[Rows][Room],
                                         std::uint32_t first) {
  store(v.x, column[0] + first);
  store(v.y, column[1] + first);
  store(v.z, column[2] + first);
}
/// The same vector for every ray.
template <typename Vector>
[[gnu::always_inline]] inline Vector spread(const double (&of)[3]) {
  return {of[0], of[1], of[2]};
}
/// Calls f with what each axis has of the vectors.
template <typename F, typename Vector, typename... V>
[[gnu::always_inline]] inline Vector by_axis(F&& f, const Vector& a, V&&... b) {
  return {f(a.x, b.x...), f(a.y, b.y...), f(a.z, b.z...)};
}
template <typename Vector>
[[gnu::always_inline]] inline Vector abs_of(const Vector& v) {
  return by_axis([](const auto& x) { return abs(x); }, v);
}
template <typename Vector>
[[gnu::always_inline]] inline auto largest_of(const Vector& v) {
  return max(max(v.x, v.y), v.z);
}
template <typename Vector>
[[gnu::always_inline]] inline auto least_of(const Vector& v) {
  return min(min(v.x, v.y), v.z);
}

/// A matrix times a vector, its columns added in their order; `on_entries` is done to each before.
template <typename OnEntries>
[[gnu::always_inline]] inline Vec3<double> times(const double (&column)[3][3],
                                                 const Vec3<double>& v, OnEntries&& on_entries) {
  const auto row = [&](int i) {
    return on_entries(Doubles(column[0][i])) * v.x + on_entries(Doubles(column[1][i])) * v.y +
           on_entries(Doubles(column[2][i])) * v.z;
  };
  return {row(0), row(1), row(2)};
}
[[gnu::always_inline]] inline Vec3<double> times(const double (&column)[3][3],
                                                 const Vec3<double>& v) {
  return times(column, v, [](const Doubles& entries) { return entries; });
}

/// Takes rays [first, first + kRayLanes) into the frame of a surface. Gives back a bit for each
/// that is left to the caller: those that begin far away, or whose numbers are too large or too
/// small.
[[gnu::always_inline]] inline Mask16 place_some(const SurfaceFrame& frame,
                                                const RayColumns<kRaysAtOnce>& world,
                                                std::uint32_t first, SurfaceRays& own) {
  using D = Doubles;
  using V = Vec3<double>;
  constexpr double kLeast = 1e-300;
  const V direction = load<V>(world.direction, first);
  const V start = load<V>(world.origin, first) - spread<V>(frame.position);
  const D fastest = largest_of(abs_of(direction));
  const D square = dot(direction, direction);
  const D towards = -dot(start, direction);
  const V way = times(frame.to_own, direction);
  const D longest = largest_of(abs_of(way));
  const D stretch = D(0.5) / power_of(longest);
  store(times(frame.to_own, start), own.ray.origin, first);
  store(way * stretch, own.ray.direction, first);
  const D coordinate =
      largest_of(times(frame.to_own, abs_of(start), [](const D& entries) { return abs(entries); }));
  store(D(kRaySlack) * (coordinate + D(frame.reach)), own.slack + first);
  store(D(0.0), own.shift + first);
  store(stretch, own.stretch + first);
  const auto near = towards <= D(4.0 * frame.size) * (square / fastest);
  const auto tame = (largest_of(abs_of(start)) < D(kMostRayLength)) &
                    (fastest < D(kMostRayLength)) & (fastest > D(1.0 / kMostRayLength)) &
                    (longest > D(kLeast)) & (longest < D(1.0 / kLeast)) &
                    (D(frame.size) < D(kMostRayLength));
  return ~bits(near & tame);
}

/// The same of rays [0, count).
inline std::uint64_t place_rays(const SurfaceFrame& frame, const RayColumns<kRaysAtOnce>& world,
                                std::uint32_t count, SurfaceRays& own) {
  std::uint64_t left = 0;
  for (std::uint32_t first = 0; first < count; first += kRayLanes) {
    const Mask16 some = place_some(frame, world, first, own);
    left |= std::uint64_t{some & lanes_below(kRayLanes)} << first;
  }
  return count < kRaysAtOnce ? left & ((std::uint64_t{1} << count) - 1U) : left;
}

/// Rays that are ready to go through a mesh, in columns. `tau` is time, in another unit, from where
/// a ray comes to the mesh, or from where it begins near it.
template <std::uint32_t Room>
struct ReadyRays {
  static constexpr std::size_t kAlignment = kRayAlignment<Room>;
  /// Of floats, more are written than are there: those of the next rays, or slack.
  static constexpr std::uint32_t kFloats = Room == 1 ? 1 : Room + kLanes;
  static constexpr std::uint32_t kRows = Room == 1 ? 4 : 3;
  /// tau = (t - entry) * pace.
  alignas(kAlignment) double entry[Room];
  alignas(kAlignment) double pace[Room];
  /// Where rays are at tau = 0, in units of the nodes, and by how much boxes are grown for what is
  /// wrong of that and of their ways.
  alignas(kAlignment) float at[kRows][kFloats];
  alignas(kAlignment) float grow[kRows][kFloats];
  /// A bound of q units is passed at q * inverse + near, or + far, where the ray enters or leaves:
  /// not later, or earlier, than it is.
  alignas(kAlignment) float inverse[kRows][kFloats];
  alignas(kAlignment) float near[kRows][kFloats];
  alignas(kAlignment) float far[kRows][kFloats];
  /// Times the inverse of the fastest axis: an area beside the ray, in units of the others, that
  /// leaves no doubt of its sign in double either.
  alignas(kAlignment) float surely[kFloats];
};

/// The same of a ray that begins so far away from the lower bounds of a mesh by the sum of its
/// axes, where `longest` is one over the pace.
///
/// The volume of an area is that by what the ray moves along the axis; it is in doubt by less than
/// half of this (see cross_sides), of which the lengths of direction are less than 3, and each of
/// three corners is no farther from the start than `away` and the extent of the mesh on all axes.
template <typename L>
[[gnu::always_inline]] inline L sure_area(const MeshSpan& mesh, const L& away, const L& slack,
                                          const L& longest) {
  const L far = L(3.0) * away + L(9.0 * mesh.extent);
  return L(2.1 * 3.0 * mesh.units_volume) * longest * far * (L(0x1p-48) * far + L(4.0) * slack);
}

/// The part of [0, limit] in which a ray is within bounds on an axis, grown by its slack: it enters
/// them then, or is there from the beginning.
template <typename L>
struct AxisPassage {
  const L slack;
  const L limit;

  /// Gives back when it enters them, and sets when it leaves: before 0 if it stands beside them.
  /// Zero times infinity narrows nothing: comparisons with it do not hold.
  [[gnu::always_inline]] L operator()(const L& from, const L& way, const L& inverse, const L& least,
                                      const L& most, L& leaves) const {
    const L zero(0.0);
    const L near = least - slack - from;
    const L far = most + slack - from;
    const auto stands = way == zero;
    const auto beside = (near > zero) | (far < zero);
    const L a = near * inverse;
    const L b = far * inverse;
    const L in = select(b < a, b, a) * L(1.0 - 0x1p-48);
    const L out = select(a < b, b, a) * L(1.0 + 0x1p-48);
    leaves = select((out < limit) & !stands, out, limit);
    leaves = select(stands & beside, L(-1.0), leaves);
    return select((zero < in) & !stands, in, zero);
  }
};

/// How rays pass bounds on an axis. `from` is where they are, and `grow` by how much boxes are
/// grown, in units of the nodes; `inverse` is how long, in tau, it takes for one.
template <typename L>
struct AxisWay {
  L inverse;
  L near;
  L far;

  [[gnu::always_inline]] AxisWay(const L& from, const L& given, const L& grow) {
    inverse =
        select(abs(given) <= L(1.0 / kStandingRate), given, with_sign(L(kStandingInverse), given));
    const L forward_grow = with_sign(grow, inverse);
    near = (-from - forward_grow) * inverse;
    far = (-from + forward_grow) * inverse;
  }
};

/// Makes rays [first, first + kRayLanes) ready, or the only one there is. Gives back bits of those
/// that do not pass the mesh by.
///
/// A bound q becomes q * inverse + near in float: three or four roundings, each of half an ulp of
/// at most (65536 + |from| + grow) * |inverse|. Where the ray is in the mesh's box, grown by its
/// slack, that is less than kUnitDoubt and 2^-20 of the slack.
template <typename Rays>
[[gnu::always_inline]] inline Mask16 make_ready(const MeshSpan& mesh,
                                                const SurfaceRayColumns<Rays::kRoom>& rays,
                                                const double* limit, std::uint32_t first,
                                                ReadyRays<Rays::kRoom>& ready) {
  using D = typename Rays::Number;
  using V = typename Rays::Vector;
  const V start = load<V>(rays.ray.origin, first);
  const V direction = load<V>(rays.ray.direction, first);
  D own_slack;
  D most;
  load(rays.slack + first, own_slack);
  load(limit + first, most);
  const D one(1.0);
  const V inverse = by_axis([](const D& way) { return D(1.0) / way; }, direction);
  V leaves;
  const AxisPassage<D> passage{own_slack, most};
  const D in = largest_of(by_axis(passage, start, direction, inverse, spread<V>(mesh.least),
                                  spread<V>(mesh.most), leaves));
  const Mask16 come = bits((in <= least_of(leaves)) & (most >= D(0.0)));
  if (come == 0) return come;
  store(in, ready.entry + first);
  const V moved = direction * in;
  const V from = start + moved;
  const D farthest = largest_of(abs_of(start) + abs_of(moved));
  const D slack = min(D(kMostSlack), own_slack + D(0x1p-51) * farthest);
  // No ray is in the box, grown by the slack, for longer than twice this.
  const D extent(mesh.extent);
  const auto is_slack = slack > D(0x1p-10) * extent;
  const D longest = select(is_slack, extent + D(2.0) * slack, extent);
  const D pace = select(is_slack, one / longest, D(mesh.pace));
  store(pace, ready.pace + first);
  V near;
  V far;
  V at;
  V grow;
  const V rate = by_axis(
      [&](const D& place, const D& time, const D& low, const D& step, const D& units, D& in_units,
          D& grown, D& to_near, D& to_far) {
        in_units = (place - low) * units;
        grown = D(kUnitDoubt) + D(1.001) * slack * units;
        const AxisWay<D> way(in_units, step * time * pace, grown);
        to_near = way.near;
        to_far = way.far;
        return way.inverse;
      },
      from, inverse, spread<V>(mesh.low), spread<V>(mesh.step), spread<V>(mesh.units), at, grow,
      near, far);
  store(at, ready.at, first);
  store(grow, ready.grow, first);
  store(rate, ready.inverse, first);
  const V away = abs_of(start - spread<V>(mesh.low));
  store(sure_area(mesh, away.x + away.y + away.z, own_slack, select(is_slack, longest, extent)),
        ready.surely + first);
  store(near, ready.near, first);
  store(far, ready.far, first);
  return come;
}

/// The same of a ray that begins near the mesh, as most do, and is measured from there: what passes
/// the mesh's box by is left to its nodes. False for others.
///
/// Where it is takes three roundings, its inverse as many, and a bound on its way to tau four: all
/// of them are of less than |at| and the largest bound.
[[gnu::always_inline]] inline bool make_near_ready(const MeshSpan& mesh, const LoneSurfaceRay& ray,
                                                   ReadyRays<1>& ready) {
  const auto& start = ray.ray.origin;
  const auto& way = ray.ray.direction;
  const double slack = ray.slack[0];
  const FloatAxes units = load_axes(mesh.float_units);
  const Numbers from{start[0][0] - mesh.low[0], start[1][0] - mesh.low[1],
                     start[2][0] - mesh.low[2]};
  const FloatAxes at = float_axes(from.x, from.y, from.z) * units;
  const FloatAxes away = absolute(at);
  if (!(are_all_below(away, kNearUnits) && slack <= 0x1p-10 * mesh.extent)) return false;
  const FloatAxes rate = float_axes(way[0][0], way[1][0], way[2][0]);
  const FloatAxes given = load_axes(mesh.float_inverse) / rate;
  const FloatAxes inverse = signed_as(
      lesser_axes(absolute(given), spread_axes(static_cast<float>(kStandingInverse))), rate);
  const FloatAxes grow = spread_axes(static_cast<float>(1.001 * slack)) * units +
                         (away * spread_axes(kNearShare) + spread_axes(kNearDoubt));
  const FloatAxes forward_grow = signed_as(grow, inverse);
  ready.entry[0] = 0.0;
  ready.pace[0] = mesh.pace;
  store_axes(at, ready.at[0]);
  store_axes(grow, ready.grow[0]);
  store_axes(inverse, ready.inverse[0]);
  store_axes((forward_grow + at) * -inverse, ready.near[0]);
  store_axes((forward_grow - at) * inverse, ready.far[0]);
  const double sum = abs(from.x) + abs(from.y) + abs(from.z);
  ready.surely[0] = static_cast<float>(sure_area(mesh, sum, slack, mesh.extent));
  return true;
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
