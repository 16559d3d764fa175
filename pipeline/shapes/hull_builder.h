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

/// Builds the hull of points; see ShapePool::add_hull. All of its columns lie in one block of
/// `memory`, which release_hull gives back. What building needs comes from `memory` too, and is
/// given back before they return.
Status hull_of_points(const PointView& points, std::pmr::memory_resource* memory, HullShape& hull);
Status hull_of_faces(const PointView& points, const HullFaces& faces,
                     std::pmr::memory_resource* memory, HullShape& hull);
/// A hull that was built before, of its vertices and its faces as they are.
Status hull_as_built(const PointView& points, const HullFaces& faces,
                     std::pmr::memory_resource* memory, HullShape& hull);

/// The points as building takes them.
[[nodiscard]] std::pmr::vector<Eigen::Vector3d> copied(const PointView& points,
                                                       std::pmr::memory_resource* memory);

/// A hull of one vertex at the origin that owns no memory.
[[nodiscard]] HullShape point_hull() noexcept;

/// Bytes of the hull's block; 0 for point_hull.
[[nodiscard]] std::size_t hull_bytes(const HullShape& hull) noexcept;
void release_hull(const HullShape& hull, std::pmr::memory_resource* memory) noexcept;

/// The surface of a hull while it is being built: face i is loops[first[i]] to loops[first[i + 1]],
/// indices of points, counter-clockwise seen from outside.
struct HullSurface {
  /// Throws what `memory` throws, as everything that grows a surface.
  explicit HullSurface(std::pmr::memory_resource* memory) : loops(memory), first(1, 0U, memory) {}

  std::pmr::vector<std::uint32_t> loops;
  std::pmr::vector<std::uint32_t> first;

  [[nodiscard]] std::size_t faces() const noexcept { return first.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> loop(std::size_t face) const noexcept {
    return {loops.data() + first[face], first[face + 1] - first[face]};
  }
  void end_face() { first.push_back(static_cast<std::uint32_t>(loops.size())); }
};

/// Joins coplanar neighbours and drops vertices that lie within faces or edges. `invalid_shape`
/// unless every edge has exactly two faces, which run along it in opposite directions, and the
/// surface is of one piece without handles. Scratch comes from the surface's memory.
Status merge_coplanar(std::span<const Eigen::Vector3d> points, HullSurface& surface);

/// Makes the block of columns in `memory`: vertices are the points that the loops use (or, without
/// faces, all points: one or two). Checks that the surface is convex. Scratch comes from the
/// surface's memory.
Status assemble_hull(std::span<const Eigen::Vector3d> points, const HullSurface& surface,
                     std::pmr::memory_resource* memory, HullShape& hull);

}  // namespace winnow
