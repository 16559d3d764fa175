#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/shape_pool.h>
#include "bench/scenes/meshes.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace winnow::bench {

/// Input of a scene engine: moving bodies, and a fixed triangle mesh at the origin (none if it is
/// empty).
struct BodySet {
  ShapePool pool;
  std::vector<ShapeId> shapes;
  std::vector<Pose> poses;
  Triangles mesh;
};

/// Returns a dense heap of boxes, spheres, capsules and hulls of 16 vertices, a quarter each, of
/// about unit size, at random positions in a cube. Overlapping bodies were pushed apart several
/// times, so that the remaining overlaps are shallow. About 8 pairs of boxes and 2.5 contacts per
/// body.
[[nodiscard]] std::unique_ptr<BodySet> make_heap(std::size_t bodies, std::uint64_t seed);

/// Returns balls of unit diameter at random positions in a cube, 7.5 contacts per body.
[[nodiscard]] std::unique_ptr<BodySet> make_balls(std::size_t bodies, std::uint64_t seed);

/// Returns hulls of 16 to 32 vertices on a terrain of 2 * cells^2 triangles of about half their
/// size; every 40th hull leans on its neighbour.
[[nodiscard]] std::unique_ptr<BodySet> make_landscape(std::size_t bodies, std::uint32_t cells,
                                                      std::uint64_t seed);

/// Adds the bodies to a scene; their client data are their rows.
[[nodiscard]] std::vector<Key> add_bodies(const BodySet& set, Scene& scene);

/// Largest displacement of a scene's bodies from their poses, along each axis and about it (in
/// radians).
struct PoseNoise {
  double along = 0.0;
  double about = 0.0;
};
/// Every object moves a little.
inline constexpr PoseNoise kMoving{0.005, 0.005};
/// Bodies at rest apart from the noise of a solver. The noise is smaller than kCacheTolerance, so
/// that contacts are cached.
inline constexpr PoseNoise kResting{1e-5, 1e-5};
inline constexpr double kCacheTolerance = 2e-4;

/// Returns the poses of a frame: each body's pose with a random displacement.
void apply_pose_noise(const BodySet& set, const PoseNoise& by, std::uint64_t frame,
                      std::vector<Pose>& poses);

}  // namespace winnow::bench
