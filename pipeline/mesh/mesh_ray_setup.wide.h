#pragma once

// Eight rays at once into the frame of a surface, and made ready for their way through the nodes of
// a mesh. In double, without fused operations: the same on every instruction set.

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

/// Rays from `first` on of a column. One that is alone is put into all lanes: its numbers have just
/// been stored, and what is wider than that would have to wait for them.
[[gnu::always_inline]] inline Doubles load(const double* column, std::uint32_t first, bool alone) {
  return alone ? Doubles(column[0]) : Doubles::load(column + first);
}
[[gnu::always_inline]] inline Vec3<double> load(const double (&column)[3][kRaysAtOnce],
                                                std::uint32_t first, bool alone) {
  return {load(column[0], first, alone), load(column[1], first, alone),
          load(column[2], first, alone)};
}
[[gnu::always_inline]] inline void store(const Vec3<double>& v, double (&column)[3][kRaysAtOnce],
                                         std::uint32_t first) {
  v.x.store(column[0] + first);
  v.y.store(column[1] + first);
  v.z.store(column[2] + first);
}
[[gnu::always_inline]] inline Vec3<double> abs_of(const Vec3<double>& v) {
  return {abs(v.x), abs(v.y), abs(v.z)};
}
[[gnu::always_inline]] inline Doubles largest_of(const Vec3<double>& v) {
  return max(max(v.x, v.y), v.z);
}

/// A matrix times a vector, its columns added in their order.
[[gnu::always_inline]] inline Vec3<double> times(const double (&m)[3][3], const Vec3<double>& v) {
  const auto row = [&](const double(&r)[3]) {
    return Doubles(r[0]) * v.x + Doubles(r[1]) * v.y + Doubles(r[2]) * v.z;
  };
  return {row(m[0]), row(m[1]), row(m[2])};
}

/// Takes rays [0, count) into the frame of a surface. Gives back a bit for each that is left to the
/// caller: those that begin far away, or whose numbers are too large or too small.
inline std::uint64_t place_rays(const SurfaceFrame& frame, const RayColumns& world,
                                std::uint32_t count, SurfaceRays& own) {
  const double(&m)[3][3] = frame.to_own;
  double size[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) size[i][k] = __builtin_fabs(m[i][k]);
  }
  const Vec3<double> position{frame.position[0], frame.position[1], frame.position[2]};
  // Infinity has the bits of the exponent alone: what they leave of a number is a power of two.
  const Doubles exponent(__builtin_inf());
  constexpr double kLeast = 1e-300;
  const bool alone = count == 1;
  std::uint64_t left = 0;
  for (std::uint32_t first = 0; first < count; first += kRayLanes) {
    const Vec3<double> direction = load(world.direction, first, alone);
    const Vec3<double> start = load(world.origin, first, alone) - position;
    const Doubles fastest = largest_of(abs_of(direction));
    const Doubles square = dot(direction, direction);
    const Doubles towards = -dot(start, direction);
    const Vec3<double> way = times(m, direction);
    const Doubles longest = largest_of(abs_of(way));
    const Doubles stretch = Doubles(0.5) / (longest & exponent);
    store(times(m, start), own.ray.origin, first);
    store(way * stretch, own.ray.direction, first);
    const Doubles coordinate = largest_of(times(size, abs_of(start)));
    (Doubles(kRaySlack) * (coordinate + Doubles(frame.reach))).store(own.slack + first);
    Doubles(0.0).store(own.shift + first);
    stretch.store(own.stretch + first);
    const LaneMask<double> near = towards <= Doubles(4.0 * frame.size) * (square / fastest);
    const LaneMask<double> tame = (largest_of(abs_of(start)) < Doubles(kMostRayLength)) &
                                  (fastest < Doubles(kMostRayLength)) &
                                  (fastest > Doubles(1.0 / kMostRayLength)) &
                                  (longest > Doubles(kLeast)) & (longest < Doubles(1.0 / kLeast)) &
                                  (Doubles(frame.size) < Doubles(kMostRayLength));
    left |= static_cast<std::uint64_t>(~bits(near & tame) & kAllLanes<double>) << first;
  }
  return count < kRaysAtOnce ? left & ((std::uint64_t{1} << count) - 1U) : left;
}

/// A ray on its way through the nodes. `tau` is time from where it comes to the mesh, in another
/// unit: it leaves the mesh's box before tau = 3.
struct RayJob {
  /// Where the ray is at tau = 0, and by how much it moves, in the mesh's lengths.
  double origin[3];
  double direction[3];
  /// tau = (t - entry) * pace.
  double entry;
  double pace;
  /// A bound of q units is passed at q * inverse + near, or + far, where the ray enters or leaves:
  /// not later, or earlier, than it is.
  float inverse[3];
  float near[3];
  float far[3];
  /// Where these bounds of sixteen nodes lie.
  std::uint32_t near_bound[3];
  std::uint32_t far_bound[3];
  /// Rows that take a vector to where it is across the ray: along two axes, less what the ray moves
  /// along each while it does so along the third, the fastest one.
  float across[2][3];
  /// By how much corners of triangles may be wrong there before they are rounded.
  float wrong;
};

/// Rays that are ready to go through a mesh, in columns.
struct ReadyRays {
  alignas(64) double entry[kRayLanes];
  alignas(64) double pace[kRayLanes];
  alignas(64) double origin[3][kRayLanes];
  alignas(64) double direction[3][kRayLanes];
  /// Of floats, half of the place is slack.
  alignas(64) float inverse[3][kLanes];
  alignas(64) float near[3][kLanes];
  alignas(64) float far[3][kLanes];
  alignas(64) float across[3][kLanes];
  alignas(64) float wrong[kLanes];
  /// Bits of those that are fastest along y and z.
  Mask16 fastest_y;
  Mask16 fastest_z;
};

/// The part of [0, limit] in which rays are in the box of a mesh. Empty if in > out.
struct BoxPassage {
  Doubles in{0.0};
  Doubles out;

  /// Zero times infinity narrows nothing: comparisons with it do not hold.
  [[gnu::always_inline]] void narrow(const Doubles& from, const Doubles& way,
                                     const Doubles& inverse, const Doubles& slack, double least,
                                     double most) {
    const Doubles near = Doubles(least) - slack - from;
    const Doubles far = Doubles(most) + slack - from;
    const LaneMask<double> stands = way == Doubles(0.0);
    const LaneMask<double> beside = (near > Doubles(0.0)) | (far < Doubles(0.0));
    const Doubles a = near * inverse;
    const Doubles b = far * inverse;
    const Doubles enters = select(b < a, b, a) * Doubles(1.0 - 0x1p-48);
    const Doubles leaves = select(a < b, b, a) * Doubles(1.0 + 0x1p-48);
    in = select((in < enters) & !stands, enters, in);
    out = select((leaves < out) & !stands, leaves, out);
    out = select(stands & beside, Doubles(-1.0), out);
  }
};

/// How rays pass bounds on an axis. `from` is where they are, and `grow` by how much boxes are
/// grown, in units of the nodes; `inverse` is how long, in tau, it takes for one.
[[gnu::always_inline]] inline void set_axis(ReadyRays& ready, int axis, const Doubles& from,
                                            Doubles inverse, const Doubles& grow) {
  const Doubles sign(-0.0);
  inverse = select(abs(inverse) <= Doubles(1.0 / kStandingRate), inverse,
                   (inverse & sign) | Doubles(kStandingInverse));
  const Doubles forward_grow = (inverse & sign) | grow;
  to_single(inverse).store(ready.inverse[axis]);
  to_single((-from - forward_grow) * inverse).store(ready.near[axis]);
  to_single((-from + forward_grow) * inverse).store(ready.far[axis]);
}

/// Rows that take a vector across the ray are made of quotients of its direction.
[[gnu::always_inline]] inline void set_across(ReadyRays& ready, const Vec3<double>& direction,
                                              const Vec3<double>& inverse) {
  const LaneMask<double> y_is_faster = abs(direction.y) > abs(direction.x);
  const Doubles faster = select(y_is_faster, abs(direction.y), abs(direction.x));
  const LaneMask<double> z = abs(direction.z) > faster;
  const LaneMask<double> y = y_is_faster & !z;
  const Doubles inverse_of_fastest = select(z, inverse.z, select(y, inverse.y, inverse.x));
  to_single(-direction.x * inverse_of_fastest).store(ready.across[0]);
  to_single(-direction.y * inverse_of_fastest).store(ready.across[1]);
  to_single(-direction.z * inverse_of_fastest).store(ready.across[2]);
  ready.fastest_y = bits(y);
  ready.fastest_z = bits(z);
}

/// Makes rays [first, first + kRayLanes) ready, or the only one there is. Gives back bits of those
/// that do not pass the mesh by.
///
/// A bound q becomes q * inverse + near in float: three or four roundings, each of half an ulp of
/// at most (65536 + |from| + grow) * |inverse|. Where the ray is in the mesh's box, grown by its
/// slack, that is less than kUnitDoubt and 2^-20 of the slack.
inline Mask16 make_ready(const MeshSpan& mesh, const SurfaceRays& rays, const double* limit,
                         std::uint32_t first, bool alone, ReadyRays& ready) {
  const Vec3<double> start = load(rays.ray.origin, first, alone);
  const Vec3<double> direction = load(rays.ray.direction, first, alone);
  const Doubles own_slack = load(rays.slack, first, alone);
  const Doubles one(1.0);
  const Vec3<double> inverse{one / direction.x, one / direction.y, one / direction.z};
  const Doubles most = load(limit, first, alone);
  BoxPassage passage{.out = most};
  passage.narrow(start.x, direction.x, inverse.x, own_slack, mesh.least[0], mesh.most[0]);
  passage.narrow(start.y, direction.y, inverse.y, own_slack, mesh.least[1], mesh.most[1]);
  passage.narrow(start.z, direction.z, inverse.z, own_slack, mesh.least[2], mesh.most[2]);
  const Mask16 come = bits((passage.in <= passage.out) & (most >= Doubles(0.0)));
  if (come == 0) return come;
  passage.in.store(ready.entry);
  const Vec3<double> moved = direction * passage.in;
  const Vec3<double> from = start + moved;
  const Doubles farthest = largest_of(abs_of(start) + abs_of(moved));
  const Doubles slack = min(Doubles(kMostSlack), own_slack + Doubles(0x1p-51) * farthest);
  // No ray is in the box, grown by the slack, for longer than twice this.
  const Doubles extent(mesh.extent);
  const LaneMask<double> is_slack = slack > Doubles(0x1p-10) * extent;
  const Doubles longest = select(is_slack, extent + Doubles(2.0) * slack, extent);
  const Doubles pace = select(is_slack, one / longest, Doubles(mesh.pace));
  pace.store(ready.pace);
  const Doubles* const at[] = {&from.x, &from.y, &from.z};
  const Doubles* const way[] = {&direction.x, &direction.y, &direction.z};
  const Doubles* const time[] = {&inverse.x, &inverse.y, &inverse.z};
  for (int axis = 0; axis < 3; ++axis) {
    const Doubles units(mesh.units[axis]);
    at[axis]->store(ready.origin[axis]);
    (*way[axis] * longest).store(ready.direction[axis]);
    set_axis(ready, axis, (*at[axis] - Doubles(mesh.low[axis])) * units,
             Doubles(mesh.step[axis]) * *time[axis] * pace,
             Doubles(kUnitDoubt) + Doubles(1.001) * slack * units);
  }
  set_across(ready, direction, inverse);
  const Doubles wrong = min(Doubles(4.0) * slack, Doubles(kMostWrong)) + Doubles(mesh.rounding);
  to_single(wrong).store(ready.wrong);
  return come;
}

/// One of them. Which way it goes is as hard to foresee as a coin: nothing branches on it.
[[gnu::always_inline]] inline void take_ready(const ReadyRays& ready, unsigned lane, RayJob& job) {
  job.entry = ready.entry[lane];
  job.pace = ready.pace[lane];
  for (unsigned axis = 0; axis < 3; ++axis) {
    job.origin[axis] = ready.origin[axis][lane];
    job.direction[axis] = ready.direction[axis][lane];
    const float inverse = ready.inverse[axis][lane];
    job.inverse[axis] = inverse;
    job.near[axis] = ready.near[axis][lane];
    job.far[axis] = ready.far[axis][lane];
    const unsigned upper = __builtin_bit_cast(std::uint32_t, inverse) >> 31U;
    job.near_bound[axis] = (axis + 3U * upper) * kMeshFanout;
    job.far_bound[axis] = (axis + 3U - 3U * upper) * kMeshFanout;
  }
  const unsigned fastest = (ready.fastest_y >> lane & 1U) + 2U * (ready.fastest_z >> lane & 1U);
  for (unsigned k = 0; k < 2; ++k) {
    const unsigned axis = (fastest + 1 + k) % 3;
    for (float& entry : job.across[k]) entry = 0.0F;
    job.across[k][axis] = 1.0F;
    job.across[k][fastest] = ready.across[axis][lane];
  }
  job.wrong = ready.wrong[lane];
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
