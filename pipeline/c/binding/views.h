#pragma once

#include <winnow/c/scene_queries.h>
#include <winnow/c/volumes.h>
#include <winnow/core/box_view.h>
#include <winnow/core/column.h>
#include <winnow/core/index_subset.h>
#include <winnow/core/point_view.h>
#include <winnow/core/pose_view.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/shape_rays.h>

#include <Eigen/Core>
#include <span>

namespace winnow::c {

// Conversion of the caller's columns to views of the engine. Columns that have the number type of
// the engine are used without a copy; others are converted into `room`. The functions return
// `invalid_argument` if a column is missing, and `out_of_memory`.

/// Boxes in double are rounded outward. If `entries` is not null, only those entries are read.
[[nodiscard]] Status read_boxes(const winnow_box_view* given, const IndexSubset* entries,
                                Column<float>& room, BoxView& boxes) noexcept;
[[nodiscard]] Status read_poses(const winnow_pose_view* given, Column<Pose>& room,
                                PoseView& poses) noexcept;
/// Returns the poses as a contiguous array.
[[nodiscard]] Status read_poses(const winnow_pose_view* given, Column<Pose>& room,
                                std::span<const Pose>& poses) noexcept;
/// Float and double are both used without a copy.
[[nodiscard]] Status read_points(const winnow_point_view* given, PointView& points) noexcept;
/// Returns the points as a contiguous array of double.
[[nodiscard]] Status read_points(const winnow_point_view* given, Column<double>& room,
                                 std::span<const Eigen::Vector3d>& points) noexcept;
[[nodiscard]] Status read_triangles(const winnow_index_view* given, IndexView& triangles) noexcept;
[[nodiscard]] Status read_rays(const winnow_shape_ray_batch* given, Column<ShapeRay>& room,
                               ShapeRayBatch& rays) noexcept;

}  // namespace winnow::c
