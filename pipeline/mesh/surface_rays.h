#pragma once

// Plain structs: kernel files include this.

#include <winnow/pipeline/surface_frame.h>

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Rays that are taken through a surface together.
inline constexpr std::uint32_t kRaysAtOnce = 64;
/// So many are made ready at once. Columns of more than one are filled up to a multiple of it, by
/// copies of the last ray.
inline constexpr std::uint32_t kRayLanes = 8;

/// Rays whose lengths are larger have products that may leave the range of double.
inline constexpr double kMostRayLength = 1e150;
/// Of coordinates: some roundings of a ray on its way into a surface's frame, and of triangles on
/// theirs into the world.
inline constexpr double kRaySlack = 0x1p-46;

template <std::uint32_t Room>
inline constexpr std::size_t kRayAlignment = Room == 1 ? 8 : 64;

/// Rays by component.
template <std::uint32_t Room>
struct RayColumns {
  alignas(kRayAlignment<Room>) double origin[3][Room];
  alignas(kRayAlignment<Room>) double direction[3][Room];
};

/// A ray in the own frame of a mesh or height field, whose length along it is about that of t.
struct SurfaceRay {
  double origin[3];
  /// The largest component is in [1/2, 1).
  double direction[3];
  /// Wherever it is near the surface, the true ray is no farther from this one.
  double slack;
  /// Triangles count that it meets at some t in [low, high].
  double low;
  double high;
};

/// The same in columns. The caller's t is shift + own t * stretch.
template <std::uint32_t Room>
struct SurfaceRayColumns {
  RayColumns<Room> ray;
  alignas(kRayAlignment<Room>) double slack[Room];
  alignas(kRayAlignment<Room>) double shift[Room];
  alignas(kRayAlignment<Room>) double stretch[Room];
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
using LoneSurfaceRay = SurfaceRayColumns<1>;

enum class Crossing : std::uint8_t { none, found, doubtful };

struct SurfaceHit {
  double t;
  /// At right angles to the triangle, against the ray, of any length.
  double normal[3];
};

}  // namespace winnow
