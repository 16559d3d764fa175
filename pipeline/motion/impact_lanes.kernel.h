#pragma once

#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/motion/impact.h"
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// Two convex shapes that move.
struct ImpactQuery {
  ShapeId shape[2];
  const RigidMotion* motion[2];
  /// A later impact is of no interest, and may be none. Whatever it is, an impact that is not later
  /// is the same.
  double until;
};

enum class ImpactVerdict : std::uint8_t {
  unsure,  ///< the lanes cannot tell; apart before the time
  known,
  invalid,  ///< a motion is not valid, which lanes never tell: to them it is unsure from the start
};

/// What turns of the pairs of a job. A sphere never does.
enum class ImpactMotion : std::uint8_t {
  straight,     ///< nothing
  turns,        ///< some of the bodies, but no half-space
  plane_turns,  ///< the half-spaces, and any of the other bodies
};

/// Queries of one pair of kinds, all of which have lanes, and where their answers go.
struct ImpactJob {
  ImpactMotion motion;
  ShapeTables tables;
  const ImpactQuery* queries;
  /// Which of the queries: indices, here and of the answers.
  const std::uint16_t* order;
  std::uint32_t count;
  /// A share of the smaller size.
  double tolerance;
  impact::Impact* found;
  ImpactVerdict* verdicts;
};

struct ImpactLaneKernels {
  void (*run)(const ImpactJob& job);
};

WINNOW_KERNELS(ImpactLaneKernels, impact_lane_kernels);

}  // namespace winnow
