#pragma once

#include "partitions/index/query_view.h"
#include "partitions/queries/cast.kernel.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// How a region and a box lie.
enum class Containment : std::uint8_t { apart, crossing, inside };

/// Decides on the box of a row (six floats), for regions that 16 lanes of float cannot.
struct ExactRegion {
  Containment (*meets)(const void* region, const float* box) = nullptr;
  const void* region = nullptr;
};

/// A half-space for tests of 16 boxes. The largest component of the normal lies in [1/16, 1/8), so
/// that nothing overflows.
struct WidePlane {
  float normal[3];
  float offset;
  std::uint8_t farthest[3];  ///< column of a box's end that lies the most inside
};

/// The part of a box that is inside of all planes. Without planes no `exact` is needed. If there
/// are `more` conditions that only `exact` knows, no test here says "inside".
struct PlaneRegion {
  float low[3];
  float high[3];
  const WidePlane* planes = nullptr;
  std::uint32_t count = 0;
  bool more = false;
  /// True if a box that reaches inside of every plane meets the region, and there is nothing more.
  bool planes_decide = false;
  /// What normal . p + offset may be off by: rounding times the largest coordinate, plus margin.
  float rounding = 0.0F;
  float margin = 0.0F;
  ExactRegion exact;
};

struct BallRegion {
  float center[3];
  float radius;
  ExactRegion exact;
};

/// What a sweep passes over.
struct SweptRegion {
  Sweep sweep;
  ExactRegion exact;
};

/// Where objects are written that lie inside, and those that cross the border.
struct RegionSinks {
  IdSink inside;
  IdSink crossing;
};

/// All return false if a sink is full.
struct RegionKernels {
  bool (*planes)(const QueryView&, const PlaneRegion&, const QueryFilter&, RegionSinks&);
  bool (*ball)(const QueryView&, const BallRegion&, const QueryFilter&, RegionSinks&);
  bool (*swept)(const QueryView&, const SweptRegion&, const QueryFilter&, RegionSinks&);
  /// All pairs (batch.id of the box, object) of a batch of boxes with the flat blocks.
  bool (*flat_boxes)(const QueryView&, const QueryBatch&, const QueryFilter&, PairSink&);
};

WINNOW_KERNELS(RegionKernels, region_kernels);

}  // namespace winnow
