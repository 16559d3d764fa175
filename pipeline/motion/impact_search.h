#pragma once

#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shapes.h>

#include <cstdint>

namespace winnow::impact {

/// When two shapes meet, as ImpactResult says it.
struct Impact {
  bool hit = false;
  double time = 1.0;
  double gap = 0.0;
  double error_bound = 0.0;
  double normal[3] = {0.0, 0.0, 0.0};
  double point[3] = {0.0, 0.0, 0.0};
  /// How often distances were computed.
  std::uint32_t samples = 0;
};

/// Of convex shapes that are in the tables, and valid motions. `tolerance` is a share of the
/// smaller shape's size.
[[nodiscard]] Impact find_impact(const ShapeTables& tables, ShapeId a, const RigidMotion& of_a,
                                 ShapeId b, const RigidMotion& of_b, double tolerance) noexcept;

}  // namespace winnow::impact
