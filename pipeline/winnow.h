#pragma once

/// @file
/// The whole public API of winnow, except for <winnow/core/eigen.h>.

/// @namespace winnow
/// Collision detection: partitions find overlapping bounding volumes, the narrow phase computes
/// pairs of shapes, and scenes combine both.

#include <winnow/core/aabb.h>
#include <winnow/core/box_view.h>
#include <winnow/core/capsule.h>
#include <winnow/core/cast.h>
#include <winnow/core/debug_draw.h>
#include <winnow/core/execution.h>
#include <winnow/core/fat_margin.h>
#include <winnow/core/filter.h>
#include <winnow/core/footprint.h>
#include <winnow/core/frustum.h>
#include <winnow/core/hits.h>
#include <winnow/core/hooks.h>
#include <winnow/core/index_subset.h>
#include <winnow/core/kdop.h>
#include <winnow/core/kdop_around.h>
#include <winnow/core/key.h>
#include <winnow/core/matrix.h>
#include <winnow/core/oriented_box.h>
#include <winnow/core/pair_buffer.h>
#include <winnow/core/pair_events.h>
#include <winnow/core/plane.h>
#include <winnow/core/point_view.h>
#include <winnow/core/pose.h>
#include <winnow/core/pose_view.h>
#include <winnow/core/ray.h>
#include <winnow/core/region.h>
#include <winnow/core/rotation.h>
#include <winnow/core/rounding.h>
#include <winnow/core/sphere.h>
#include <winnow/core/status.h>
#include <winnow/core/vec3.h>
#include <winnow/core/volume.h>
#include <winnow/partitions/debug_colours.h>
#include <winnow/partitions/partition.h>
#include <winnow/partitions/scene_features.h>
#include <winnow/partitions/structures.h>
#include <winnow/pipeline/cluster.h>
#include <winnow/pipeline/cluster_queries.h>
#include <winnow/pipeline/cluster_scene.h>
#include <winnow/pipeline/cluster_transport.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/contact_groups.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/deformable_mesh.h>
#include <winnow/pipeline/feature_impacts.h>
#include <winnow/pipeline/height_field.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/recording.h>
#include <winnow/pipeline/replay.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/sensors.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/shape_rays.h>
#include <winnow/pipeline/time_of_impact.h>
#include <winnow/pipeline/triangle_mesh.h>
#include <winnow/simd/isa.h>
