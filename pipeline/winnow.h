#pragma once

/// @file
/// The whole public API of winnow, except for <winnow/core/eigen.h>.

/// @namespace winnow
/// Collision detection: partitions find overlapping bounding volumes, the narrow phase computes
/// pairs of shapes, and scenes combine both.

#include <winnow/core/debug_draw.h>
#include <winnow/core/execution.h>
#include <winnow/core/filter.h>
#include <winnow/core/hooks.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include <winnow/core/point_view.h>
#include <winnow/core/pose.h>
#include <winnow/core/rays.h>
#include <winnow/core/regions.h>
#include <winnow/core/results.h>
#include <winnow/core/status.h>
#include <winnow/core/vectors.h>
#include <winnow/core/volumes.h>
#include <winnow/partitions/partition.h>
#include <winnow/partitions/structures.h>
#include <winnow/pipeline/cluster.h>
#include <winnow/pipeline/cluster_scene.h>
#include <winnow/pipeline/cluster_transport.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/contact_groups.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/deformable_mesh.h>
#include <winnow/pipeline/impacts.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/recording.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/sensors.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/shape_rays.h>
#include <winnow/pipeline/surfaces.h>
#include <winnow/simd/isa.h>
