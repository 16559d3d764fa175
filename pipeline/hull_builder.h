#pragma once

#include <winnow/core/status.h>
#include <winnow/pipeline/shape_pool.h>

#include <Eigen/Core>
#include <cstddef>
#include <memory_resource>
#include <span>

namespace winnow {

/// Builds the hull of points; see ShapePool::add_hull. All of its columns lie in one block of
/// `memory`, which release_hull gives back.
Status hull_of_points(std::span<const Eigen::Vector3d> points, std::pmr::memory_resource* memory,
                      HullShape& hull);
Status hull_of_faces(std::span<const Eigen::Vector3d> points, const HullFaces& faces,
                     std::pmr::memory_resource* memory, HullShape& hull);

/// A hull of one vertex at the origin that owns no memory.
[[nodiscard]] HullShape point_hull() noexcept;

/// Bytes of the hull's block; 0 for point_hull.
[[nodiscard]] std::size_t hull_bytes(const HullShape& hull) noexcept;
void release_hull(const HullShape& hull, std::pmr::memory_resource* memory) noexcept;

}  // namespace winnow
