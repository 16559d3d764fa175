#pragma once

// Rays into the frame of a surface, and made ready for their way through the nodes of a mesh: eight
// at once, or one alone, whose lanes are its axes. In double, without fused operations: the same
// either way and on every instruction set.

#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_traversal.h"
#include "simd/lanes/axes.h"
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
inline constexpr double kMostWrong = 1e38;

/// Eight rays: a lane for each.
struct RaysInLanes {
  static constexpr std::uint32_t kRoom = kRaysAtOnce;
  using Number = Doubles;
  using Lane = Doubles;
  using Vector = Vec3<double>;
};
/// One ray: a lane for each axis.
struct AxesInLanes {
  static constexpr std::uint32_t kRoom = 1;
  using Number = double;
  using Lane = Axes;
  using Vector = Axes;
};

// What both are written in: numbers,

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
[[gnu::always_inline]] inline Mask16 bits(int holds) {
  return holds != 0 ? 1U : 0U;
}
[[gnu::always_inline]] inline double select(bool holds, double a, double b) {
  return holds ? a : b;
}
[[gnu::always_inline]] inline double min(double a, double b) {
  return a < b ? a : b;
}
[[gnu::always_inline]] inline double max(double a, double b) {
  return a > b ? a : b;
}
/// The power of two of its exponent. Infinity has the bits of the exponent alone.
[[gnu::always_inline]] inline Doubles power_of(const Doubles& v) {
  return v & Doubles(__builtin_inf());
}
[[gnu::always_inline]] inline double power_of(double v) {
  constexpr std::uint64_t kExponent = 0x7FF0000000000000U;
  return __builtin_bit_cast(double, __builtin_bit_cast(std::uint64_t, v) & kExponent);
}

// and vectors.

/// Calls f with what each axis has of the vectors.
template <typename F, typename... V>
[[gnu::always_inline]] inline Vec3<double> by_axis(F&& f, const Vec3<double>& a, V&&... b) {
  return {f(a.x, b.x...), f(a.y, b.y...), f(a.z, b.z...)};
}
template <typename F, typename... V>
[[gnu::always_inline]] inline Axes by_axis(F&& f, const Axes& a, V&&... b) {
  return f(a, b...);
}
/// The same vector for every ray.
[[gnu::always_inline]] inline void spread(const double (&of)[3], Vec3<double>& v) {
  v = {of[0], of[1], of[2]};
}
[[gnu::always_inline]] inline void spread(const double (&of)[3], Axes& v) {
  v = load_axes(of);
}
template <typename V>
[[gnu::always_inline]] inline V spread(const double (&of)[3]) {
  V v;
  spread(of, v);
  return v;
}
/// The same of numbers that the caller has just stored.
[[gnu::always_inline]] inline void spread_stored(const double (&of)[3], Vec3<double>& v) {
  spread(of, v);
}
[[gnu::always_inline]] inline void spread_stored(const double (&of)[3], Axes& v) {
  v = join_axes(of[0], of[1], of[2]);
}
[[gnu::always_inline]] inline void load(const double (&column)[3][kRaysAtOnce], std::uint32_t first,
                                        Vec3<double>& v) {
  v = {Doubles::load(column[0] + first), Doubles::load(column[1] + first),
       Doubles::load(column[2] + first)};
}
[[gnu::always_inline]] inline void load(const double (&column)[4][1], std::uint32_t, Axes& v) {
  v = load_axes(column[0]);
}
[[gnu::always_inline]] inline void load_stored(const double (&column)[3][kRaysAtOnce],
                                               std::uint32_t first, Vec3<double>& v) {
  load(column, first, v);
}
[[gnu::always_inline]] inline void load_stored(const double (&column)[4][1], std::uint32_t,
                                               Axes& v) {
  v = join_axes(column[0][0], column[1][0], column[2][0]);
}
template <typename T, std::size_t Stride>
[[gnu::always_inline]] inline void store(const Vec3<double>& v, T (&column)[3][Stride],
                                         std::uint32_t first) {
  store(v.x, column[0] + first);
  store(v.y, column[1] + first);
  store(v.z, column[2] + first);
}
template <typename T>
[[gnu::always_inline]] inline void store(const Axes& v, T (&column)[4][1], std::uint32_t) {
  store_axes(v, column[0]);
}
/// The axes of a vector by themselves.
struct Components {
  alignas(64) double of[Axes::kCount];

  [[gnu::always_inline]] explicit Components(const Axes& v) { v.store(of); }
};
template <typename V>
[[gnu::always_inline]] inline V abs_of(const V& v) {
  return by_axis([](const auto& x) { return abs(x); }, v);
}
[[gnu::always_inline]] inline Doubles largest_of(const Vec3<double>& v) {
  return max(max(v.x, v.y), v.z);
}
[[gnu::always_inline]] inline double largest_of(const Axes& v) {
  const Components c(v);
  return max(max(c.of[0], c.of[1]), c.of[2]);
}
[[gnu::always_inline]] inline Doubles least_of(const Vec3<double>& v) {
  return min(min(v.x, v.y), v.z);
}
[[gnu::always_inline]] inline double least_of(const Axes& v) {
  const Components c(v);
  return min(min(c.of[0], c.of[1]), c.of[2]);
}
[[gnu::always_inline]] inline double dot(const Axes& a, const Axes& b) {
  const Components c(a * b);
  return c.of[0] + c.of[1] + c.of[2];
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
template <typename OnEntries>
[[gnu::always_inline]] inline Axes times(const double (&column)[3][3], const Axes& v,
                                         OnEntries&& on_entries) {
  const Components c(v);
  return on_entries(join_axes(column[0][0], column[0][1], column[0][2])) * Axes(c.of[0]) +
         on_entries(join_axes(column[1][0], column[1][1], column[1][2])) * Axes(c.of[1]) +
         on_entries(join_axes(column[2][0], column[2][1], column[2][2])) * Axes(c.of[2]);
}
template <typename V>
[[gnu::always_inline]] inline V times(const double (&column)[3][3], const V& v) {
  return times(column, v, [](const auto& entries) { return entries; });
}

/// Takes rays from `first` on into the frame of a surface. Gives back a bit for each that is left
/// to the caller: those that begin far away, or whose numbers are too large or too small.
template <typename Rays>
[[gnu::always_inline]] inline Mask16 place_some(const SurfaceFrame& frame,
                                                const RayColumns<Rays::kRoom>& world,
                                                std::uint32_t first,
                                                SurfaceRayColumns<Rays::kRoom>& own) {
  using D = typename Rays::Number;
  using V = typename Rays::Vector;
  constexpr double kLeast = 1e-300;
  V direction;
  load_stored(world.direction, first, direction);
  V start;
  load_stored(world.origin, first, start);
  V position;
  spread_stored(frame.position, position);
  start = start - position;
  const D fastest = largest_of(abs_of(direction));
  const D square = dot(direction, direction);
  const D towards = -dot(start, direction);
  const V way = times(frame.to_own, direction);
  const D longest = largest_of(abs_of(way));
  const D stretch = D(0.5) / power_of(longest);
  store(times(frame.to_own, start), own.ray.origin, first);
  store(way * stretch, own.ray.direction, first);
  const D coordinate = largest_of(
      times(frame.to_own, abs_of(start), [](const auto& entries) { return abs(entries); }));
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

/// The same of one.
inline bool place_ray(const SurfaceFrame& frame, const RayColumns<1>& world, LoneSurfaceRay& own) {
  return (place_some<AxesInLanes>(frame, world, 0, own) & 1U) == 0;
}
/// The same of rays [0, count).
inline std::uint64_t place_rays(const SurfaceFrame& frame, const RayColumns<kRaysAtOnce>& world,
                                std::uint32_t count, SurfaceRays& own) {
  std::uint64_t left = 0;
  for (std::uint32_t first = 0; first < count; first += kRayLanes) {
    const Mask16 some = place_some<RaysInLanes>(frame, world, first, own);
    left |= std::uint64_t{some & lanes_below(kRayLanes)} << first;
  }
  return count < kRaysAtOnce ? left & ((std::uint64_t{1} << count) - 1U) : left;
}

/// Rays that are ready to go through a mesh, in columns. `tau` is time from where a ray comes to
/// the mesh, in another unit: it leaves the mesh's box before tau = 3.
template <std::uint32_t Room>
struct ReadyRays {
  static constexpr std::size_t kAlignment = kRayAlignment<Room>;
  static constexpr std::uint32_t kRows = kVectorRows<Room>;
  /// Of floats, more are written than are there: those of the next rays, or slack.
  static constexpr std::uint32_t kFloats = Room == 1 ? 1 : Room + kLanes;
  /// tau = (t - entry) * pace.
  alignas(kAlignment) double entry[Room];
  alignas(kAlignment) double pace[Room];
  /// Where rays are at tau = 0, and by how much they move, in the mesh's lengths.
  alignas(kAlignment) double origin[kRows][Room];
  alignas(kAlignment) double direction[kRows][Room];
  /// A bound of q units is passed at q * inverse + near, or + far, where the ray enters or leaves:
  /// not later, or earlier, than it is.
  alignas(kAlignment) float inverse[kRows][kFloats];
  alignas(kAlignment) float near[kRows][kFloats];
  alignas(kAlignment) float far[kRows][kFloats];
  /// Rows that take a vector to where it is across the ray: along two axes, less what the ray moves
  /// along each while it does so along the third, the fastest one.
  alignas(kAlignment) float across[2][3][kFloats];
  /// By how much corners of triangles may be wrong there before they are rounded.
  alignas(kAlignment) float wrong[kFloats];
};

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
    const typename L::Mask stands = way == zero;
    const typename L::Mask beside = (near > zero) | (far < zero);
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
    const L sign(-0.0);
    inverse =
        select(abs(given) <= L(1.0 / kStandingRate), given, (given & sign) | L(kStandingInverse));
    const L forward_grow = (inverse & sign) | grow;
    near = (-from - forward_grow) * inverse;
    far = (-from + forward_grow) * inverse;
  }
};

/// Rows that take a vector across rays are made of quotients of their directions. Which way a ray
/// goes is as hard to foresee as a coin: nothing branches on it.
[[gnu::always_inline]] inline void set_across(ReadyRays<kRaysAtOnce>& ready, std::uint32_t first,
                                              const Vec3<double>& direction,
                                              const Vec3<double>& inverse) {
  using D = Doubles;
  const auto y_is_faster = abs(direction.y) > abs(direction.x);
  const auto faster = select(y_is_faster, abs(direction.y), abs(direction.x));
  const auto z = abs(direction.z) > faster;
  const auto y = y_is_faster & !z;
  const auto by_fastest = [&](const D& if_x, const D& if_y, const D& if_z) {
    return select(z, if_z, select(y, if_y, if_x));
  };
  const D back = -by_fastest(inverse.x, inverse.y, inverse.z);
  const Vec3<double> along = direction * back;
  const D one(1.0);
  const D none(0.0);
  store(Vec3<double>{by_fastest(along.y, none, one), by_fastest(one, along.z, none),
                     by_fastest(none, one, along.x)},
        ready.across[0], first);
  store(Vec3<double>{by_fastest(along.z, one, none), by_fastest(none, along.x, one),
                     by_fastest(one, none, along.y)},
        ready.across[1], first);
}
[[gnu::always_inline]] inline void set_across(ReadyRays<1>& ready, std::uint32_t,
                                              const Axes& direction, const Axes& inverse) {
  constexpr int kNext[3] = {1, 2, 0};
  const Components size(abs(direction));
  const int faster = size.of[1] > size.of[0] ? 1 : 0;
  const int fastest = size.of[2] > max(size.of[0], size.of[1]) ? 2 : faster;
  const int second = kNext[fastest];
  const int third = kNext[second];
  const Components along(direction * Axes(-Components(inverse).of[fastest]));
  ready.across[0][fastest][0] = static_cast<float>(along.of[second]);
  ready.across[0][second][0] = 1.0F;
  ready.across[0][third][0] = 0.0F;
  ready.across[1][fastest][0] = static_cast<float>(along.of[third]);
  ready.across[1][second][0] = 0.0F;
  ready.across[1][third][0] = 1.0F;
}

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
  using L = typename Rays::Lane;
  V start;
  V direction;
  D own_slack;
  D most;
  load(rays.ray.origin, first, start);
  load(rays.ray.direction, first, direction);
  load(rays.slack + first, own_slack);
  load(limit + first, most);
  const D one(1.0);
  const V inverse = by_axis([](const L& way) { return L(1.0) / way; }, direction);
  V leaves;
  const AxisPassage<L> passage{own_slack, most};
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
  store(from, ready.origin, first);
  store(direction * longest, ready.direction, first);
  V near;
  V far;
  const V rate = by_axis(
      [&](const L& at, const L& time, const L& low, const L& step, const L& units, L& to_near,
          L& to_far) {
        const AxisWay<L> way((at - low) * units, step * time * L(pace),
                             L(kUnitDoubt) + L(1.001) * L(slack) * units);
        to_near = way.near;
        to_far = way.far;
        return way.inverse;
      },
      from, inverse, spread<V>(mesh.low), spread<V>(mesh.step), spread<V>(mesh.units), near, far);
  store(rate, ready.inverse, first);
  store(near, ready.near, first);
  store(far, ready.far, first);
  set_across(ready, first, direction, inverse);
  const D wrong = min(D(4.0) * slack, D(kMostWrong)) + D(mesh.rounding);
  store(wrong, ready.wrong + first);
  return come;
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
