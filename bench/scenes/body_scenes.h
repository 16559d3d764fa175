#pragma once

#include <winnow/core/pose.h>
#include "bench/scenes/body_set.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace winnow::bench {

/// Boxes, spheres, capsules and hulls of 16 vertices, about unit size, a quarter each, that lie
/// close: random places in a cube, pushed apart until they hardly overlap. About 8 pairs of boxes
/// and 2.5 contacts a body.
[[nodiscard]] std::unique_ptr<BodySet> make_heap(std::size_t bodies, std::uint64_t seed);

/// Balls of unit diameter at random places in a cube, 7.5 contacts a body.
[[nodiscard]] std::unique_ptr<BodySet> make_balls(std::size_t bodies, std::uint64_t seed);

/// Hulls of 16 to 32 vertices that lie on a terrain of 2 * cells^2 triangles of about half their
/// size; every 40th leans on its neighbour.
[[nodiscard]] std::unique_ptr<BodySet> make_landscape(std::size_t bodies, std::uint32_t cells,
                                                      std::uint64_t seed);

/// How far bodies of a scene stray from their places, along and about each axis (in radians).
struct Stray {
  double along = 0.0;
  double about = 0.0;
};
/// Every object moving a little.
inline constexpr Stray kMoving{0.005, 0.005};
/// At rest but for rounding, as a solver leaves bodies: less than what contacts are carried over.
inline constexpr Stray kResting{1e-5, 1e-5};
inline constexpr double kCarryOver = 2e-4;

/// The poses of a frame: each body at a random place near its own.
void stray(const BodySet& set, const Stray& by, std::uint64_t frame, std::vector<Pose>& poses);

/// A torus of 20,000 triangles, and where a copy stands so that so many pairs of triangles meet.
[[nodiscard]] Triangles make_race_torus();
struct TorusPose {
  std::size_t about;  ///< pairs of triangles
  Pose pose;
};
[[nodiscard]] const std::array<TorusPose, 4>& torus_poses();

}  // namespace winnow::bench
