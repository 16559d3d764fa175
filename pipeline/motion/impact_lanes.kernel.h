#pragma once

#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shapes.h>
#include "simd/kernels/kernels.h"

#include <cstdint>

namespace winnow {

/// Two convex shapes that move, and the times between which they may meet: they are apart before.
struct ImpactQuery {
  ShapeId shape[2];
  const RigidMotion* motion[2];
  double first;
  double last;
};

enum class ImpactVerdict : std::uint8_t {
  unsure,  ///< the lanes cannot tell; apart before `time`
  apart,   ///< within the times that were asked about
  meets,
};

/// What lanes say of a query; all but the verdict and the time only where they meet. As of Impact.
struct ImpactLane {
  ImpactVerdict verdict;
  double time;
  double gap;
  double error_bound;
  double normal[3];
  double point[3];
};

/// At most so many queries per job.
inline constexpr std::uint32_t kImpactJobQueries = 64;

/// Queries of one pair of kinds, all of which have lanes, and where their answers go.
struct ImpactJob {
  ShapeTables tables;
  const ImpactQuery* queries;
  std::uint32_t count;
  /// A share of the smaller size.
  double tolerance;
  ImpactLane* answers;
};

struct ImpactLaneKernels {
  void (*run)(const ImpactJob& job);
};

WINNOW_KERNELS(ImpactLaneKernels, impact_lane_kernels);

/// Kinds that have lanes.
[[nodiscard]] constexpr bool has_impact_lanes(ShapeKind kind) noexcept {
  return kind == ShapeKind::sphere || kind == ShapeKind::capsule || kind == ShapeKind::box ||
         kind == ShapeKind::hull || kind == ShapeKind::triangle || kind == ShapeKind::cylinder ||
         kind == ShapeKind::cone;
}

}  // namespace winnow
