#pragma once

// Transforms rays to the frame of a surface and prepares them for the traversal of a mesh's nodes:
// eight at a time, one per SIMD lane, or a single ray. make_ready computes in double, without fused
// operations, so that lanes and scalars have equal results on every instruction set.
// make_near_ready prepares a single ray in float. mesh_rays.kernel.cpp uses this.

#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_rays.kernel.h"
#include "simd/lanes/float_axes.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// Error bound, in node units, of a bound converted in float to the parameter tau (see ReadyRays).
inline constexpr double kUnitError = 0.05;
/// A ray that moves along an axis by fewer node units per unit of tau than this is treated as
/// static on this axis: while it crosses the mesh, it moves by less than kUnitError.
inline constexpr double kStaticRate = 0.01;
inline constexpr double kStaticInverse = 1e30;
/// With this slack, all triangles are uncertain. A larger slack is clamped to it.
inline constexpr double kMaxSlack = 1e200;

// Constants for rays measured in float from their own origin; u is half an ulp of 1.

/// The origin is at most this many units away along any axis, so that the ray leaves the mesh
/// before tau = 200.
inline constexpr float kNearUnits = 0x1p22F;
/// Error bound of the ray's position and of its distance to a bound, which take at most 12
/// roundings: kNearShare, 32 u, of the position, plus kNearError, in units, which is more than the
/// same share of the largest bound, 65536.
inline constexpr float kNearShare = 0x1p-19F;
inline constexpr float kNearError = 0.5F;

/// A vector of three scalars.
struct ScalarVec3 {
  double x;
  double y;
  double z;

  [[gnu::always_inline]] friend ScalarVec3 operator+(const ScalarVec3& a, const ScalarVec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  [[gnu::always_inline]] friend ScalarVec3 operator-(const ScalarVec3& a, const ScalarVec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  [[gnu::always_inline]] friend ScalarVec3 operator*(const ScalarVec3& a, double s) {
    return {a.x * s, a.y * s, a.z * s};
  }
};

/// Traits for eight rays in lanes.
struct LaneRays {
  static constexpr std::uint32_t kRoom = kRaysAtOnce;
  using Number = Doubles;
  using Vector = Vec3<double>;
};
/// Traits for one ray in scalars.
struct ScalarRay {
  static constexpr std::uint32_t kRoom = 1;
  using Number = double;
  using Vector = ScalarVec3;
};

// Functions that both variants are written in.

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
[[gnu::always_inline]] inline Mask16 bits(bool condition) {
  return condition ? 1U : 0U;
}
[[gnu::always_inline]] inline double select(bool condition, double a, double b) {
  return condition ? a : b;
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
/// `size` with the sign of `of`; the sign bit of `size` must not be set.
[[gnu::always_inline]] inline double with_sign(double size, double of) {
  return __builtin_copysign(size, of);
}
[[gnu::always_inline]] inline Doubles with_sign(const Doubles& size, const Doubles& of) {
  return (of & Doubles(-0.0)) | size;
}
/// The power of two with the exponent of v: infinity has exactly the exponent bits.
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
/// Broadcasts one vector to all rays.
template <typename Vector>
[[gnu::always_inline]] inline Vector spread(const double (&of)[3]) {
  return {of[0], of[1], of[2]};
}
/// Applies f to the components of the vectors, axis by axis.
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

/// A matrix times a vector, summed column by column; `on_entries` is applied to each entry before.
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

/// Transforms rays [first, first + kRayLanes) to the frame of a surface. Returns a bit for each ray
/// that the caller must transform: rays that begin far away, or have numbers that are too large or
/// too small.
[[gnu::always_inline]] inline Mask16 place_some(const SurfaceFrame& frame,
                                                const RayColumns<kRaysAtOnce>& world,
                                                std::uint32_t first, SurfaceRays& own) {
  using D = Doubles;
  using V = Vec3<double>;
  constexpr double kMinLength = 1e-300;
  const V direction = load<V>(world.direction, first);
  const V start = load<V>(world.origin, first) - spread<V>(frame.position);
  const D fastest = largest_of(abs_of(direction));
  const D square = dot(direction, direction);
  const D towards = -dot(start, direction);
  const V way = times(frame.world_to_local, direction);
  const D longest = largest_of(abs_of(way));
  const D t_scale = D(0.5) / power_of(longest);
  store(times(frame.world_to_local, start), own.ray.origin, first);
  store(way * t_scale, own.ray.direction, first);
  const D coordinate = largest_of(
      times(frame.world_to_local, abs_of(start), [](const D& entries) { return abs(entries); }));
  store(D(kRaySlack) * (coordinate + D(frame.reach)), own.slack + first);
  store(D(0.0), own.shift + first);
  store(t_scale, own.t_scale + first);
  const auto near = towards <= D(kFarSizes * frame.size) * (square / fastest);
  const auto in_range = (largest_of(abs_of(start)) < D(kMaxRayLength)) &
                        (fastest < D(kMaxRayLength)) & (fastest > D(1.0 / kMaxRayLength)) &
                        (longest > D(kMinLength)) & (longest < D(1.0 / kMinLength)) &
                        (D(frame.size) < D(kMaxRayLength));
  return ~bits(near & in_range);
}

/// As above, for rays [0, count).
inline std::uint64_t place_rays(const SurfaceFrame& frame, const RayColumns<kRaysAtOnce>& world,
                                std::uint32_t count, SurfaceRays& own) {
  std::uint64_t left = 0;
  for (std::uint32_t first = 0; first < count; first += kRayLanes) {
    const Mask16 some = place_some(frame, world, first, own);
    left |= std::uint64_t{some & lanes_below(kRayLanes)} << first;
  }
  return count < kRaysAtOnce ? left & ((std::uint64_t{1} << count) - 1U) : left;
}

/// Rays prepared for the traversal of a mesh, in columns. `tau` is a scaled time: it is measured
/// from the entry into the mesh's box (make_ready) or from the ray's origin (make_near_ready).
template <std::uint32_t Room>
struct ReadyRays {
  static constexpr std::size_t kAlignment = kRayAlignment<Room>;
  /// Float columns have room for a full vector store, which may write beyond the rays stored here.
  static constexpr std::uint32_t kFloats = Room == 1 ? 1 : Room + kLanes;
  static constexpr std::uint32_t kRows = Room == 1 ? 4 : 3;
  /// tau = (t - entry) * pace.
  alignas(kAlignment) double entry[Room];
  alignas(kAlignment) double pace[Room];
  /// Position of rays at tau = 0, in node units, and the amount by which boxes are grown to cover
  /// the errors of position and direction.
  alignas(kAlignment) float at[kRows][kFloats];
  alignas(kAlignment) float grow[kRows][kFloats];
  /// A ray passes a bound of q units at tau = q * inverse + near if it enters, q * inverse + far if
  /// it leaves. Rounding errors never make an entry later or an exit earlier.
  alignas(kAlignment) float inverse[kRows][kFloats];
  alignas(kAlignment) float near[kRows][kFloats];
  alignas(kAlignment) float far[kRows][kFloats];
  /// Multiplied by |inverse| of the fastest axis: an area beside the ray, in units of the other
  /// axes, that is large enough to have a certain sign in double, too.
  alignas(kAlignment) float surely[kFloats];
};

/// ReadyRays::surely for a ray whose origin is `away` from the lower bounds of a mesh (sum over the
/// axes); `longest` is 1 / pace.
///
/// The volume of cross_sides is the area times the ray's movement along the fastest axis. Its error
/// is less than half of the value here (see cross_sides): the components of direction sum to less
/// than 3, and each of the three corners is no farther from the origin than `away` plus the extent
/// of the mesh on all axes.
template <typename L>
[[gnu::always_inline]] inline L sure_area(const MeshSpan& mesh, const L& away, const L& slack,
                                          const L& longest) {
  const L far = L(3.0) * away + L(9.0 * mesh.extent);
  return L(2.1 * 3.0 * mesh.units_volume) * longest * far * (L(0x1p-48) * far + L(4.0) * slack);
}

/// Computes the part of [0, limit] in which a ray is within bounds on one axis, which are grown by
/// `slack`.
template <typename L>
struct AxisInterval {
  const L slack;
  const L limit;

  /// Returns the time at which the ray enters the bounds (0 if it begins inside), and sets `leaves`
  /// to the time at which it leaves them. `leaves` is negative if the ray is outside the bounds and
  /// does not move along the axis. The product of zero and infinity is NaN, which compares false
  /// and narrows nothing.
  [[gnu::always_inline]] L operator()(const L& from, const L& way, const L& inverse, const L& least,
                                      const L& most, L& leaves) const {
    const L zero(0.0);
    const L near = least - slack - from;
    const L far = most + slack - from;
    const auto is_static = way == zero;
    const auto beside = (near > zero) | (far < zero);
    const L a = near * inverse;
    const L b = far * inverse;
    const L in = select(b < a, b, a) * L(1.0 - 0x1p-48);
    const L out = select(a < b, b, a) * L(1.0 + 0x1p-48);
    leaves = select((out < limit) & !is_static, out, limit);
    leaves = select(is_static & beside, L(-1.0), leaves);
    return select((zero < in) & !is_static, in, zero);
  }
};

/// Coefficients for a ray passing bounds on one axis. `from` is its position and `grow` the growth
/// of boxes, in node units; `given` is the time in tau per unit.
template <typename L>
struct AxisCoefficients {
  L inverse;
  L near;
  L far;

  [[gnu::always_inline]] AxisCoefficients(const L& from, const L& given, const L& grow) {
    inverse =
        select(abs(given) <= L(1.0 / kStaticRate), given, with_sign(L(kStaticInverse), given));
    const L forward_grow = with_sign(grow, inverse);
    near = (-from - forward_grow) * inverse;
    far = (-from + forward_grow) * inverse;
  }
};

/// Prepares rays [first, first + kRayLanes), or the only one. Returns a bit for each ray that does
/// not miss the mesh's box.
///
/// A bound q becomes q * inverse + near in float: three or four roundings, each of half an ulp of
/// at most (65536 + |from| + grow) * |inverse|. Within the mesh's box, grown by the slack, this is
/// less than kUnitError plus 2^-20 of the slack.
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
  const AxisInterval<D> interval{own_slack, most};
  const D in = largest_of(by_axis(interval, start, direction, inverse, spread<V>(mesh.least),
                                  spread<V>(mesh.most), leaves));
  const Mask16 hits_box = bits((in <= least_of(leaves)) & (most >= D(0.0)));
  if (hits_box == 0) return hits_box;
  store(in, ready.entry + first);
  const V moved = direction * in;
  const V from = start + moved;
  const D farthest = largest_of(abs_of(start) + abs_of(moved));
  const D slack = min(D(kMaxSlack), own_slack + D(0x1p-51) * farthest);
  // No ray is in the box, grown by the slack, for longer than twice `longest`.
  const D extent(mesh.extent);
  const auto has_large_slack = slack > D(0x1p-10) * extent;
  const D longest = select(has_large_slack, extent + D(2.0) * slack, extent);
  const D pace = select(has_large_slack, one / longest, D(mesh.pace));
  store(pace, ready.pace + first);
  V near;
  V far;
  V at;
  V grow;
  const V rate = by_axis(
      [&](const D& place, const D& time, const D& low, const D& step, const D& units, D& in_units,
          D& grown, D& to_near, D& to_far) {
        in_units = (place - low) * units;
        grown = D(kUnitError) + D(1.001) * slack * units;
        const AxisCoefficients<D> way(in_units, step * time * pace, grown);
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
  store(sure_area(mesh, away.x + away.y + away.z, own_slack, longest), ready.surely + first);
  store(near, ready.near, first);
  store(far, ready.far, first);
  return hits_box;
}

/// As make_ready, for a single ray that begins near the mesh (kNearUnits) and has a small slack;
/// tau is measured from its origin. Does not test the mesh's box, because the traversal tests the
/// nodes. Returns false for other rays.
///
/// The position takes three roundings, `inverse` as many, and a bound's conversion to tau four,
/// each of half an ulp of at most the sum of |at| and the largest bound.
[[gnu::always_inline]] inline bool make_near_ready(const MeshSpan& mesh,
                                                   const SingleSurfaceRay& ray,
                                                   ReadyRays<1>& ready) {
  const auto& start = ray.ray.origin;
  const auto& way = ray.ray.direction;
  const double slack = ray.slack[0];
  const FloatAxes units = load_axes(mesh.float_units);
  const ScalarVec3 from{start[0][0] - mesh.low[0], start[1][0] - mesh.low[1],
                        start[2][0] - mesh.low[2]};
  const FloatAxes at = float_axes(from.x, from.y, from.z) * units;
  const FloatAxes away = absolute(at);
  if (!(are_all_below(away, kNearUnits) && slack <= 0x1p-10 * mesh.extent)) return false;
  const FloatAxes rate = float_axes(way[0][0], way[1][0], way[2][0]);
  const FloatAxes given = load_axes(mesh.float_inverse) / rate;
  const FloatAxes inverse = signed_as(
      lesser_axes(absolute(given), spread_axes(static_cast<float>(kStaticInverse))), rate);
  const FloatAxes grow = spread_axes(static_cast<float>(1.001 * slack)) * units +
                         (away * spread_axes(kNearShare) + spread_axes(kNearError));
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
