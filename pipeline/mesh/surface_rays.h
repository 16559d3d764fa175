#pragma once

// Rays in the frame of a mesh or height field, and ray-triangle hits. Only plain structs.

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Frame of a surface (mesh or height field) in the world.
struct SurfaceFrame {
  double position[3];           ///< position of the surface's origin in the world
  double world_to_local[3][3];  ///< columns of the matrix from world vectors to the frame
  bool is_rotated;              ///< false if that matrix is the identity
  double reach;                 ///< upper bound of the surface's coordinates in the frame
  double size;                  ///< upper bound of them in world axes, about the origin
};

/// Rays that are traversed together.
inline constexpr std::uint32_t kRaysAtOnce = 64;
/// Rays prepared at once, one per lane. Columns of more than one ray are padded to a multiple of
/// this with copies of the last ray.
inline constexpr std::uint32_t kRayLanes = 8;

/// Products of the components of longer vectors may leave the range of double.
inline constexpr double kMaxRayLength = 1e150;
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

/// A ray in the frame of a mesh or height field. Its parameter is scaled so that lengths along it
/// are about equal to t.
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

enum class Crossing : std::uint8_t { none, found, uncertain };

struct SurfaceHit {
  double t;
  /// Orthogonal to the triangle, against the ray; of any length.
  double normal[3];
};

}  // namespace winnow
