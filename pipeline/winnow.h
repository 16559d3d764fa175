#pragma once

/// The whole public API of winnow.

#include <winnow/core/aabb.h>
#include <winnow/core/box_view.h>
#include <winnow/core/capsule.h>
#include <winnow/core/cast.h>
#include <winnow/core/debug_draw.h>
#include <winnow/core/execution.h>
#include <winnow/core/filter.h>
#include <winnow/core/footprint.h>
#include <winnow/core/frustum.h>
#include <winnow/core/hits.h>
#include <winnow/core/kdop.h>
#include <winnow/core/key.h>
#include <winnow/core/oriented_box.h>
#include <winnow/core/pair_buffer.h>
#include <winnow/core/pair_events.h>
#include <winnow/core/plane.h>
#include <winnow/core/pose.h>
#include <winnow/core/ray.h>
#include <winnow/core/region.h>
#include <winnow/core/rounding.h>
#include <winnow/core/sphere.h>
#include <winnow/core/status.h>
#include <winnow/partitions/bounds_n_squared.h>
#include <winnow/partitions/debug_colours.h>
#include <winnow/partitions/flat_grid.h>
#include <winnow/partitions/linear_bvh.h>
#include <winnow/partitions/n_squared.h>
#include <winnow/partitions/partition.h>
#include <winnow/partitions/sweep_and_prune.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/shape_rays.h>
#include <winnow/simd/isa.h>
