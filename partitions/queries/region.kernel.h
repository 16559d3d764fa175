#pragma once

#include "partitions/index/query_view.h"
#include "partitions/queries/cast.kernel.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// Relation of a box to a region.
enum class Containment : std::uint8_t { apart, crossing, inside };

/// Test in double of the box of a row (six floats), for rows that the float tests leave undecided.
struct ExactRegion {
  Containment (*classify)(const void* region, const float* box) = nullptr;
  const void* region = nullptr;
};

/// A half-space for float tests. The largest component of the normal is in [1/16, 1/8), so that
/// nothing overflows.
struct WidePlane {
  float normal[3];
  float offset;
  std::uint8_t farthest[3];  ///< per axis, the column of the box's end farthest inside
};

/// The part of a box that is inside all planes. Without planes `exact` is not needed. `more` means
/// that only `exact` tests some conditions: the float tests then never return "inside".
struct PlaneRegion {
  float low[3];
  float high[3];
  const WidePlane* planes = nullptr;
  std::uint32_t count = 0;
  bool more = false;
  /// True if the planes decide: a box that overlaps [low, high] and reaches inside every plane
  /// overlaps the region.
  bool planes_decide = false;
  /// Error bound of normal . p + offset: rounding * largest coordinate + slack.
  float rounding = 0.0F;
  float slack = 0.0F;
  ExactRegion exact;
};

struct BallRegion {
  float center[3];
  float radius;
  ExactRegion exact;
};

/// The volume along the path of a moving box, which contains a capsule.
struct CapsuleRegion {
  KernelCast cast;
  ExactRegion exact;
};

/// Outputs for objects inside the region and for objects that cross its border.
struct RegionSinks {
  IdSink inside;
  IdSink crossing;
};

/// All functions return false if a sink is full and cannot grow.
struct RegionKernels {
  bool (*planes)(const QueryView&, const PlaneRegion&, const QueryFilter&, RegionSinks&);
  bool (*ball)(const QueryView&, const BallRegion&, const QueryFilter&, RegionSinks&);
  bool (*capsule)(const QueryView&, const CapsuleRegion&, const QueryFilter&, RegionSinks&);
  /// Finds all pairs (batch.id of the box, object) of a batch of boxes with the flat blocks.
  bool (*flat_boxes)(const QueryView&, const QueryBatch&, const QueryFilter&, PairSink&);
};

WINNOW_KERNELS(RegionKernels, region_kernels);

}  // namespace winnow
