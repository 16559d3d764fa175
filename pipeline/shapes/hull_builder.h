#pragma once

#include <winnow/core/status.h>
#include <winnow/pipeline/shape_pool.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

namespace winnow {

/// Distances that count as 0 while a hull is built, relative to its size.
struct HullTolerance {
  /// Faces whose vertices are so close to one plane are merged. A depth error of this size is below
  /// the error bound of the tier `reference`.
  double coplanar = 1e-13;
  /// Neighbours may reach this far beyond a face.
  double convex = 1e-9;
};

/// Builds a hull from points or faces; see ShapePool::add_hull. All columns of the hull are in one
/// block of `memory`; free it with release_hull. Scratch also comes from `memory` and is freed
/// before the functions return.
Status hull_of_points(const PointView& points, std::pmr::memory_resource* memory, HullShape& hull);
Status hull_of_faces(const PointView& points, const HullFaces& faces,
                     std::pmr::memory_resource* memory, HullShape& hull,
                     const HullTolerance& tolerance = {});
/// Rebuilds a hull from the vertices and faces of a built hull, without merging faces.
Status rebuild_hull(const PointView& points, const HullFaces& faces,
                    std::pmr::memory_resource* memory, HullShape& hull);

/// Copies the points into contiguous vectors.
[[nodiscard]] std::pmr::vector<Eigen::Vector3d> copied(const PointView& points,
                                                       std::pmr::memory_resource* memory);

/// A hull of one vertex at the origin that owns no memory.
[[nodiscard]] HullShape point_hull() noexcept;

/// Size of the hull's block in bytes; 0 for point_hull and for a default-constructed hull.
[[nodiscard]] std::size_t hull_bytes(const HullShape& hull) noexcept;
void release_hull(const HullShape& hull, std::pmr::memory_resource* memory) noexcept;

/// The surface of a hull under construction. Face i is loops[first[i]] to loops[first[i + 1]],
/// indices of points, counter-clockwise seen from outside.
struct HullSurface {
  /// Throws if `memory` throws, as do all operations that grow the surface.
  explicit HullSurface(std::pmr::memory_resource* memory) : loops(memory), first(1, 0U, memory) {}

  std::pmr::vector<std::uint32_t> loops;
  std::pmr::vector<std::uint32_t> first;

  [[nodiscard]] std::size_t faces() const noexcept { return first.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> loop(std::size_t face) const noexcept {
    return {loops.data() + first[face], first[face + 1] - first[face]};
  }
  void end_face() { first.push_back(static_cast<std::uint32_t>(loops.size())); }
};

/// Merges coplanar neighbouring faces and drops vertices inside faces or edges. Returns
/// `invalid_shape` unless each edge has exactly two faces, which traverse it in opposite
/// directions, and the surface is connected and has no handles (genus 0). Scratch comes from the
/// surface's memory.
Status merge_coplanar(std::span<const Eigen::Vector3d> points, HullSurface& surface,
                      const HullTolerance& tolerance = {});

/// Allocates the block of columns in `memory` and fills it. The vertices are the points that the
/// loops use, or all points (one or two) if there are no faces. Returns `invalid_shape` if the
/// surface is not convex. Scratch comes from the surface's memory.
Status assemble_hull(std::span<const Eigen::Vector3d> points, const HullSurface& surface,
                     std::pmr::memory_resource* memory, HullShape& hull,
                     const HullTolerance& tolerance = {});

}  // namespace winnow
