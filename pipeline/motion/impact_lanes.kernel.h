#pragma once

#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/motion/impact.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// Two convex shapes in motion.
struct ImpactQuery {
  ShapeId shape[2];
  const RigidMotion* motion[2];
  /// An impact later than this may be reported as none; other results do not depend on it.
  double until;
};

enum class ImpactVerdict : std::uint8_t {
  unsure,  ///< the lanes cannot decide; the pair is disjoint before Impact::time
  decided,
  invalid,  ///< a motion is not valid; the lanes report this as unsure at time 0
};

/// Which bodies of the pairs in a job rotate. A sphere never counts as rotating.
enum class ImpactMotion : std::uint8_t {
  straight,     ///< none
  turns,        ///< some bodies, but no half-space
  plane_turns,  ///< the half-spaces, and any of the other bodies
};

/// Queries of one pair of kinds that the lanes support, and the arrays of their results.
struct ImpactJob {
  ImpactMotion motion;
  ShapeTables tables;
  const ImpactQuery* queries;
  /// Indices of this job's queries, and of their results.
  const std::uint16_t* order;
  std::uint32_t count;
  /// Relative to the size of the smaller shape.
  double tolerance;
  impact::Impact* found;
  ImpactVerdict* verdicts;
};

struct ImpactLaneKernels {
  void (*run)(const ImpactJob& job);
};

WINNOW_KERNELS(ImpactLaneKernels, impact_lane_kernels);

}  // namespace winnow
