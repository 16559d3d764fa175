#pragma once

// Eight rays at once into the frame of a surface, and made ready for their way through the nodes of
// a mesh. In double, without fused operations: the same on every instruction set.

#include <type_traits>

#include "pipeline/mesh/mesh_lanes.wide.h"
#include "pipeline/mesh/mesh_traversal.h"
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

/// Numbers of rays side by side, or of one alone.
template <bool Alone>
using RayDoubles = std::conditional_t<Alone, OneDouble, Doubles>;
template <bool Alone>
using RayVec3 = Vec3<double, RayDoubles<Alone>::kParts>;

/// Those from `first` on of a column. One that is alone is put into all lanes: its numbers have
/// just been stored, and what is wider than that would have to wait for them.
template <bool Alone>
[[gnu::always_inline]] inline RayDoubles<Alone> load(const double* column, std::uint32_t first) {
  if constexpr (Alone) return column[first];
  return RayDoubles<Alone>::load(column + first);
}
template <bool Alone>
[[gnu::always_inline]] inline RayVec3<Alone> load(const double (&column)[3][kRaysAtOnce],
                                                  std::uint32_t first) {
  return {load<Alone>(column[0], first), load<Alone>(column[1], first),
          load<Alone>(column[2], first)};
}
template <int Parts>
[[gnu::always_inline]] inline void store(const Vec3<double, Parts>& v,
                                         double (&column)[3][kRaysAtOnce], std::uint32_t first) {
  v.x.store(column[0] + first);
  v.y.store(column[1] + first);
  v.z.store(column[2] + first);
}
template <int Parts>
[[gnu::always_inline]] inline Vec3<double, Parts> abs_of(const Vec3<double, Parts>& v) {
  return {abs(v.x), abs(v.y), abs(v.z)};
}
template <int Parts>
[[gnu::always_inline]] inline Lanes<double, Parts> largest_of(const Vec3<double, Parts>& v) {
  return max(max(v.x, v.y), v.z);
}

/// A matrix times a vector, its columns added in their order.
template <int Parts>
[[gnu::always_inline]] inline Vec3<double, Parts> times(const double (&m)[3][3],
                                                        const Vec3<double, Parts>& v) {
  using D = Lanes<double, Parts>;
  const auto row = [&](const double(&r)[3]) {
    return D(r[0]) * v.x + D(r[1]) * v.y + D(r[2]) * v.z;
  };
  return {row(m[0]), row(m[1]), row(m[2])};
}

/// Takes rays from `first` on into the frame of a surface. Gives back a bit for each that is left
/// to the caller: those that begin far away, or whose numbers are too large or too small.
template <bool Alone>
[[gnu::always_inline]] inline Mask16 place_some(const SurfaceFrame& frame, const RayColumns& world,
                                                std::uint32_t first, SurfaceRays& own) {
  using D = RayDoubles<Alone>;
  using V = RayVec3<Alone>;
  const double(&m)[3][3] = frame.to_own;
  double size[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) size[i][k] = __builtin_fabs(m[i][k]);
  }
  const V position{frame.position[0], frame.position[1], frame.position[2]};
  // Infinity has the bits of the exponent alone: what they leave of a number is a power of two.
  const D exponent(__builtin_inf());
  constexpr double kLeast = 1e-300;
  const V direction = load<Alone>(world.direction, first);
  const V start = load<Alone>(world.origin, first) - position;
  const D fastest = largest_of(abs_of(direction));
  const D square = dot(direction, direction);
  const D towards = -dot(start, direction);
  const V way = times(m, direction);
  const D longest = largest_of(abs_of(way));
  const D stretch = D(0.5) / (longest & exponent);
  store(times(m, start), own.ray.origin, first);
  store(way * stretch, own.ray.direction, first);
  const D coordinate = largest_of(times(size, abs_of(start)));
  (D(kRaySlack) * (coordinate + D(frame.reach))).store(own.slack + first);
  D(0.0).store(own.shift + first);
  stretch.store(own.stretch + first);
  const auto near = towards <= D(4.0 * frame.size) * (square / fastest);
  const auto tame = (largest_of(abs_of(start)) < D(kMostRayLength)) &
                    (fastest < D(kMostRayLength)) & (fastest > D(1.0 / kMostRayLength)) &
                    (longest > D(kLeast)) & (longest < D(1.0 / kLeast)) &
                    (D(frame.size) < D(kMostRayLength));
  return ~bits(near & tame) & lanes_below(D::kCount);
}

/// The same of rays [0, count).
inline std::uint64_t place_rays(const SurfaceFrame& frame, const RayColumns& world,
                                std::uint32_t count, SurfaceRays& own) {
  if (count == 1) return place_some<true>(frame, world, 0, own) & 1U;
  std::uint64_t left = 0;
  for (std::uint32_t first = 0; first < count; first += kRayLanes) {
    left |= std::uint64_t{place_some<false>(frame, world, first, own)} << first;
  }
  return count < kRaysAtOnce ? left & ((std::uint64_t{1} << count) - 1U) : left;
}

/// Rays that are ready to go through a mesh, in columns. `tau` is time from where a ray comes to
/// the mesh, in another unit: it leaves the mesh's box before tau = 3.
struct ReadyRays {
  /// tau = (t - entry) * pace.
  alignas(64) double entry[kRaysAtOnce];
  alignas(64) double pace[kRaysAtOnce];
  /// Where rays are at tau = 0, and by how much they move, in the mesh's lengths.
  alignas(64) double origin[3][kRaysAtOnce];
  alignas(64) double direction[3][kRaysAtOnce];
  /// Of floats, more are written than are there: those of the next rays, or slack.
  static constexpr std::uint32_t kFloats = kRaysAtOnce + kLanes;
  /// A bound of q units is passed at q * inverse + near, or + far, where the ray enters or leaves:
  /// not later, or earlier, than it is.
  alignas(64) float inverse[3][kFloats];
  alignas(64) float near[3][kFloats];
  alignas(64) float far[3][kFloats];
  /// Rows that take a vector to where it is across the ray: along two axes, less what the ray moves
  /// along each while it does so along the third, the fastest one.
  alignas(64) float across[2][3][kFloats];
  /// By how much corners of triangles may be wrong there before they are rounded.
  alignas(64) float wrong[kFloats];
};

/// The part of [0, limit] in which rays are in the box of a mesh. Empty if in > out.
template <int Parts>
struct BoxPassage {
  using D = Lanes<double, Parts>;
  D in{0.0};
  D out;

  /// Zero times infinity narrows nothing: comparisons with it do not hold.
  [[gnu::always_inline]] void narrow(const D& from, const D& way, const D& inverse, const D& slack,
                                     double least, double most) {
    const D near = D(least) - slack - from;
    const D far = D(most) + slack - from;
    const typename D::Mask stands = way == D(0.0);
    const typename D::Mask beside = (near > D(0.0)) | (far < D(0.0));
    const D a = near * inverse;
    const D b = far * inverse;
    const D enters = select(b < a, b, a) * D(1.0 - 0x1p-48);
    const D leaves = select(a < b, b, a) * D(1.0 + 0x1p-48);
    in = select((in < enters) & !stands, enters, in);
    out = select((leaves < out) & !stands, leaves, out);
    out = select(stands & beside, D(-1.0), out);
  }
};

/// How rays pass bounds on an axis. `from` is where they are, and `grow` by how much boxes are
/// grown, in units of the nodes; `inverse` is how long, in tau, it takes for one.
template <int Parts>
[[gnu::always_inline]] inline void set_axis(ReadyRays& ready, std::uint32_t first, int axis,
                                            const Lanes<double, Parts>& from,
                                            Lanes<double, Parts> inverse,
                                            const Lanes<double, Parts>& grow) {
  using D = Lanes<double, Parts>;
  const D sign(-0.0);
  inverse = select(abs(inverse) <= D(1.0 / kStandingRate), inverse,
                   (inverse & sign) | D(kStandingInverse));
  const D forward_grow = (inverse & sign) | grow;
  to_single(inverse).store_unaligned(ready.inverse[axis] + first);
  to_single((-from - forward_grow) * inverse).store_unaligned(ready.near[axis] + first);
  to_single((-from + forward_grow) * inverse).store_unaligned(ready.far[axis] + first);
}

/// Rows that take a vector across the ray are made of quotients of its direction. Which way a ray
/// goes is as hard to foresee as a coin: nothing branches on it.
template <int Parts>
[[gnu::always_inline]] inline void set_across(ReadyRays& ready, std::uint32_t first,
                                              const Vec3<double, Parts>& direction,
                                              const Vec3<double, Parts>& inverse) {
  using D = Lanes<double, Parts>;
  const auto y_is_faster = abs(direction.y) > abs(direction.x);
  const auto faster = select(y_is_faster, abs(direction.y), abs(direction.x));
  const auto z = abs(direction.z) > faster;
  const auto y = y_is_faster & !z;
  const auto by_fastest = [&](const D& if_x, const D& if_y, const D& if_z) {
    return select(z, if_z, select(y, if_y, if_x));
  };
  const D back = -by_fastest(inverse.x, inverse.y, inverse.z);
  const D along_x = direction.x * back;
  const D along_y = direction.y * back;
  const D along_z = direction.z * back;
  const D one(1.0);
  const D none(0.0);
  const D row[2][3] = {{by_fastest(along_y, none, one), by_fastest(one, along_z, none),
                        by_fastest(none, one, along_x)},
                       {by_fastest(along_z, one, none), by_fastest(none, along_x, one),
                        by_fastest(one, none, along_y)}};
  for (int k = 0; k < 2; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      to_single(row[k][axis]).store_unaligned(ready.across[k][axis] + first);
    }
  }
}

/// Makes rays [first, first + kRayLanes) ready, or the only one there is. Gives back bits of those
/// that do not pass the mesh by.
///
/// A bound q becomes q * inverse + near in float: three or four roundings, each of half an ulp of
/// at most (65536 + |from| + grow) * |inverse|. Where the ray is in the mesh's box, grown by its
/// slack, that is less than kUnitDoubt and 2^-20 of the slack.
template <bool Alone>
inline Mask16 make_ready(const MeshSpan& mesh, const SurfaceRays& rays, const double* limit,
                         std::uint32_t first, ReadyRays& ready) {
  using D = RayDoubles<Alone>;
  using V = RayVec3<Alone>;
  const V start = load<Alone>(rays.ray.origin, first);
  const V direction = load<Alone>(rays.ray.direction, first);
  const D own_slack = load<Alone>(rays.slack, first);
  const D one(1.0);
  const V inverse{one / direction.x, one / direction.y, one / direction.z};
  const D most = load<Alone>(limit, first);
  BoxPassage<D::kParts> passage{.out = most};
  passage.narrow(start.x, direction.x, inverse.x, own_slack, mesh.least[0], mesh.most[0]);
  passage.narrow(start.y, direction.y, inverse.y, own_slack, mesh.least[1], mesh.most[1]);
  passage.narrow(start.z, direction.z, inverse.z, own_slack, mesh.least[2], mesh.most[2]);
  const Mask16 come = bits((passage.in <= passage.out) & (most >= D(0.0)));
  if (come == 0) return come;
  passage.in.store(ready.entry + first);
  const V moved = direction * passage.in;
  const V from = start + moved;
  const D farthest = largest_of(abs_of(start) + abs_of(moved));
  const D slack = min(D(kMostSlack), own_slack + D(0x1p-51) * farthest);
  // No ray is in the box, grown by the slack, for longer than twice this.
  const D extent(mesh.extent);
  const typename D::Mask is_slack = slack > D(0x1p-10) * extent;
  const D longest = select(is_slack, extent + D(2.0) * slack, extent);
  const D pace = select(is_slack, one / longest, D(mesh.pace));
  pace.store(ready.pace + first);
  const D* const at[] = {&from.x, &from.y, &from.z};
  const D* const way[] = {&direction.x, &direction.y, &direction.z};
  const D* const time[] = {&inverse.x, &inverse.y, &inverse.z};
  for (int axis = 0; axis < 3; ++axis) {
    const D units(mesh.units[axis]);
    at[axis]->store(ready.origin[axis] + first);
    (*way[axis] * longest).store(ready.direction[axis] + first);
    set_axis(ready, first, axis, (*at[axis] - D(mesh.low[axis])) * units,
             D(mesh.step[axis]) * *time[axis] * pace, D(kUnitDoubt) + D(1.001) * slack * units);
  }
  set_across(ready, first, direction, inverse);
  const D wrong = min(D(4.0) * slack, D(kMostWrong)) + D(mesh.rounding);
  to_single(wrong).store_unaligned(ready.wrong + first);
  return come;
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
