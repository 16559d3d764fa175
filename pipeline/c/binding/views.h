#pragma once

#include <winnow/c/scene_queries.h>
#include <winnow/c/volumes.h>
#include <winnow/core/box_view.h>
#include <winnow/core/column.h>
#include <winnow/core/entries.h>
#include <winnow/core/point_view.h>
#include <winnow/core/pose_view.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/shape_rays.h>

#include <Eigen/Core>
#include <span>

namespace winnow::c {

// Columns of a caller as the engine reads them: where they lie, if they are of the numbers that it
// keeps, and else from `room`, which they are brought into. `invalid_argument` for columns that are
// missing, `out_of_memory`.

/// Boxes of double are rounded outward; of some entries alone, the others are not read.
[[nodiscard]] Status read_boxes(const winnow_box_view* given, const Entries* entries,
                                Column<float>& room, BoxView& boxes) noexcept;
[[nodiscard]] Status read_poses(const winnow_pose_view* given, Column<Pose>& room,
                                PoseView& poses) noexcept;
/// The same one after another.
[[nodiscard]] Status read_poses(const winnow_pose_view* given, Column<Pose>& room,
                                std::span<const Pose>& poses) noexcept;
/// Float and double are both read where they lie.
[[nodiscard]] Status read_points(const winnow_point_view* given, PointView& points) noexcept;
/// One after another, in double.
[[nodiscard]] Status read_points(const winnow_point_view* given, Column<double>& room,
                                 std::span<const Eigen::Vector3d>& points) noexcept;
[[nodiscard]] Status read_triangles(const winnow_index_view* given, IndexView& triangles) noexcept;
[[nodiscard]] Status read_rays(const winnow_shape_ray_batch* given, Column<ShapeRay>& room,
                               ShapeRayBatch& rays) noexcept;

}  // namespace winnow::c
