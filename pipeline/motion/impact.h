#pragma once

#include <cstdint>

namespace winnow::impact {

/// The first impact of two shapes; members as in ImpactResult.
struct Impact {
  bool hit = false;
  double time = 1.0;
  double gap = 0.0;
  double error_bound = 0.0;
  Vec3d normal{};
  Vec3d point{};
  /// Number of distance computations by the scalar search (ImpactSearch).
  std::uint32_t samples = 0;
};

/// Returns whether the shapes overlap or touch at the start.
[[nodiscard]] inline bool touches_at_start(const Impact& impact) noexcept {
  return impact.hit && impact.time == 0.0 && impact.gap <= 0.0;
}

}  // namespace winnow::impact
