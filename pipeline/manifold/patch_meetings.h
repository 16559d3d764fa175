#pragma once

#include "pipeline/manifold/patch_outline.h"

#include <cmath>
#include <cstdint>

namespace winnow {

/// A place where two patches are, seen along the normal: patch 0 is that of a.
struct Meeting {
  double x;
  double y;
  double height[2];
  std::uint32_t id[2];
};

/// The corners of what two outlines share, in order around it.
struct Meetings {
  Meeting point[2 * kOutlineVertices];
  std::uint32_t count = 0;
  /// Points closer than that are one, and points so little outside of a side are inside.
  double same;

  explicit Meetings(double tolerance) noexcept : same(tolerance) {}

  void add(const Meeting& m) noexcept {
    for (std::uint32_t i = 0; i<count; i += count> 1 ? count - 1 : 1) {
      if (std::abs(point[i].x - m.x) <= same && std::abs(point[i].y - m.y) <= same) return;
    }
    point[count++] = m;
  }
};

/// Finds them; where outlines do not meet, as rounding or a caller's normal may have it, the one
/// place where they come closest.
void find_meetings(const Outline& a, const Outline& b, Meetings& out) noexcept;

}  // namespace winnow
