#pragma once

#include <cstdint>

namespace winnow::impact {

/// When two shapes meet, as ImpactResult says it. Plain: kernel files include this.
struct Impact {
  bool hit = false;
  double time = 1.0;
  double gap = 0.0;
  double error_bound = 0.0;
  double normal[3] = {0.0, 0.0, 0.0};
  double point[3] = {0.0, 0.0, 0.0};
  /// How often distances were computed one pair at a time.
  std::uint32_t samples = 0;
};

/// True of shapes that share a point at the start.
[[nodiscard]] inline bool touches_at_start(const Impact& impact) noexcept {
  return impact.hit && impact.time == 0.0 && impact.gap <= 0.0;
}

}  // namespace winnow::impact
