#pragma once

// Rays in the frame of a mesh or height field, and the kernels that trace them through a mesh. Only
// plain structs. pipeline/composites/rays.cpp transforms rays to the frame and calls the kernels.

#include "pipeline/mesh/mesh_view.h"
#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Rays that are placed and prepared together; half of them are traversed at a time.
inline constexpr std::uint32_t kRaysAtOnce = 64;
/// Rays prepared at once, one per lane. Columns of more than one ray are padded to a multiple of
/// this with copies of the last ray.
inline constexpr std::uint32_t kRayLanes = 8;

/// Products of the components of longer vectors may leave the range of double.
inline constexpr double kMaxRayLength = 1e150;
/// A ray begins far away if the point of it that is nearest to the surface's origin is more than
/// this many sizes of the surface ahead. Its origin is then moved along the ray until that point is
/// so far ahead: the ray still begins outside of the surface, and its coordinates have no larger
/// rounding errors than those of the surface.
inline constexpr double kFarSizes = 4.0;
/// Slack relative to coordinates: a few roundings of a ray's transformation to a surface's frame,
/// and of triangles' transformation to the world.
inline constexpr double kRaySlack = 0x1p-46;

template <std::uint32_t Room>
inline constexpr std::size_t kRayAlignment = Room == 1 ? 8 : 64;

/// Origins and directions of rays, in columns.
template <std::uint32_t Room>
struct RayColumns {
  alignas(kRayAlignment<Room>) double origin[3][Room];
  alignas(kRayAlignment<Room>) double direction[3][Room];
};

/// A ray in the frame of a mesh or height field. Its parameter (own t) is scaled so that it is
/// about the length along the ray.
struct SurfaceRay {
  double origin[3];
  /// The largest component is in [1/2, 1) in magnitude.
  double direction[3];
  /// Bound on the distance between this ray and the exact one, near the surface.
  double slack;
  /// Only hits at t in [low, high] count.
  double low;
  double high;
};

/// Rays in columns. The caller's t is shift + own t * t_scale.
template <std::uint32_t Room>
struct SurfaceRayColumns {
  RayColumns<Room> ray;
  alignas(kRayAlignment<Room>) double slack[Room];
  alignas(kRayAlignment<Room>) double shift[Room];
  alignas(kRayAlignment<Room>) double t_scale[Room];
  alignas(kRayAlignment<Room>) double low[Room];
  alignas(kRayAlignment<Room>) double high[Room];

  [[nodiscard]] SurfaceRay operator[](std::uint32_t i) const noexcept {
    const auto& from = ray.origin;
    const auto& way = ray.direction;
    return {{from[0][i], from[1][i], from[2][i]},
            {way[0][i], way[1][i], way[2][i]},
            slack[i],
            low[i],
            high[i]};
  }
};

using SurfaceRays = SurfaceRayColumns<kRaysAtOnce>;
using SingleSurfaceRay = SurfaceRayColumns<1>;

/// Converts t of the caller to t of the ray in the frame of a surface ("own" t).
struct LocalRayTime {
  double shift;
  /// 1 / t_scale, a power of two.
  double unit;

  [[nodiscard, gnu::always_inline]] double operator()(double t) const noexcept {
    return (t - shift) * unit;
  }
  /// Upper bound of own t, including rounding errors.
  [[nodiscard, gnu::always_inline]] double limit(double t) const noexcept {
    return (*this)(t) + 0x1p-51 * (__builtin_fabs(t) + __builtin_fabs(shift)) * unit;
  }
  /// As above with a wider bound, for a limit that comes from another surface: rounding may make
  /// the hit of a triangle that the ray grazes earlier than the entry into its box.
  [[nodiscard, gnu::always_inline]] double first_limit(double t, double reach) const noexcept {
    const double most = limit(t);
    return most + 0x1p-20 * (__builtin_fabs(most) + reach);
  }
};

/// Whether a ray crosses a triangle; `uncertain` if rounding or the ray's slack may change this.
enum class Crossing : std::uint8_t { none, found, uncertain };

/// A ray's hit on one triangle, in the frame of the surface.
struct SurfaceHit {
  /// Own t.
  double t;
  /// Orthogonal to the triangle, against the ray; of any length.
  double normal[3];
  /// The ray comes from the side from which the corners run clockwise.
  bool from_behind;
};

/// Receives all triangles that a ray crosses. The functions return the ray's new limit; a negative
/// limit ends the ray.
struct CrossingVisitor {
  /// Called for a triangle that the ray certainly crosses.
  double (*visit_hit)(void* context, std::uint32_t slot, const SurfaceHit& hit,
                      double limit) = nullptr;
  /// Called for a triangle that the ray may cross.
  double (*visit_candidate)(void* context, std::uint32_t slot, double limit) = nullptr;
  void* context = nullptr;
};

/// Transforms the normal of a hit to the world, and normalises it.
[[gnu::always_inline]] inline void set_normal(const SurfaceFrame& frame, const double (&given)[3],
                                              PartHit& hit) noexcept {
  constexpr double kSafe = 1e200;
  double n[3] = {given[0], given[1], given[2]};
  if (frame.is_rotated) {
    for (int i = 0; i < 3; ++i) {
      const double(&column)[3] = frame.world_to_local[i];
      n[i] = column[0] * given[0] + column[1] * given[1] + column[2] * given[2];
    }
  }
  const double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  hit.has_unit_normal = square > 1.0 / kSafe && square < kSafe;
  const double scale = hit.has_unit_normal ? 1.0 / __builtin_sqrt(square) : 1.0;
  for (int i = 0; i < 3; ++i) hit.normal[i] = (hit.has_unit_normal ? n[i] : given[i]) * scale;
}

/// The closest hit of each ray: of equal t, the one with the smallest part number; or any hit.
template <std::uint32_t Room>
struct ClosestHits {
  /// Ends a ray at its first hit.
  bool any;
  /// Ignores triangles that rays reach from behind.
  bool is_one_sided;
  const SurfaceFrame* frame;
  /// Added to the numbers of triangles.
  std::uint32_t first_part;
  /// Tests a triangle that the ray may cross. Returns the new limit in the caller's t, negative to
  /// end the ray; improves the hit itself.
  double (*test)(void* context, std::uint32_t ray, std::uint32_t slot, double limit);
  void* context;
  /// Limits in the caller's t, and the initial ones in own t. A negative limit skips a ray.
  double limit[Room];
  alignas(kRayAlignment<Room>) double own_limit[Room];
  /// See LocalRayTime.
  double unit[Room];
  /// The hit of each ray so far.
  PartHit* best[Room];

  [[nodiscard, gnu::always_inline]] LocalRayTime time(const SurfaceRayColumns<Room>& rays,
                                                      std::uint32_t i) const noexcept {
    return {rays.shift[i], unit[i]};
  }
  /// Sets the limit in the caller's t, and returns the new limit in own t.
  [[gnu::always_inline]] double lower(const SurfaceRayColumns<Room>& rays, std::uint32_t i,
                                      double now, double own_before) noexcept {
    const double before = limit[i];
    limit[i] = now;
    if (now < 0.0) return -1.0;
    return now < before ? time(rays, i).limit(now) : own_before;
  }
  /// Adds a hit of ray i, and returns the new limit in own t.
  [[gnu::always_inline]] double take(const SurfaceRayColumns<Room>& rays, std::uint32_t i,
                                     std::uint32_t number, const SurfaceHit& hit,
                                     double own_before) noexcept {
    const double t = rays.shift[i] + hit.t * rays.t_scale[i];
    if (!(t <= limit[i]) || (is_one_sided && hit.from_behind)) return own_before;
    PartHit& to = *best[i];
    const std::uint32_t part = first_part + number;
    if (to.found && t == to.t && to.part < part) return own_before;
    to.found = true;
    to.part = part;
    to.t = t;
    set_normal(*frame, hit.normal, to);
    return lower(rays, i, any ? -1.0 : t, own_before);
  }
};

/// `closest` and `closest_of_one` trace rays of scenes, `all` tests solids; `place` and `cross` are
/// steps of callers that trace rays through other surfaces, too.
struct MeshRayKernels {
  /// Transforms rays to the frame of a surface; returns a bit for each ray that the caller must
  /// transform.
  std::uint64_t (*place)(const SurfaceFrame& frame, const RayColumns<kRaysAtOnce>& world,
                         std::uint32_t count, SurfaceRays& own);
  /// Finds the closest hits of the first `count` rays. Rays are padded with copies of the last ray
  /// to a multiple of kRayLanes, and their own limits with -1.
  void (*closest)(const MeshView& mesh, const SurfaceRays& rays, std::uint32_t count,
                  ClosestHits<kRaysAtOnce>& hits);
  void (*closest_of_one)(const MeshView& mesh, const SingleSurfaceRay& ray, ClosestHits<1>& hits);
  /// Visits all triangles that a ray crosses or may cross at some t in [0, limit], roughly in order
  /// of t.
  void (*all)(const MeshView& mesh, const SingleSurfaceRay& ray, double limit,
              const CrossingVisitor& visitor);
  /// Tests whether a ray crosses a triangle at a t in [low, high].
  Crossing (*cross)(const SurfaceRay& ray, const double (&corner)[3][3], SurfaceHit& hit);
};

WINNOW_KERNELS(MeshRayKernels, mesh_ray_kernels);

}  // namespace winnow
