#pragma once

#include <cstdint>

#include "pipeline/shapes/frame.h"

namespace winnow {

/// A manifold of a dynamic body with a fixed one, as seen from the dynamic body's position.
struct FloorContact {
  enum class Source : std::uint8_t { convex, part, region, dropped };

  std::uint32_t body;
  std::uint32_t floor;
  /// Which of the convex or of the composite pairs it is of.
  std::uint32_t pair;
  /// Where the answer lies, in its source.
  std::uint32_t answer;
  Source source;
  /// How many points there are, on the fixed body's surface; the deepest of them.
  std::uint8_t count;
  std::uint8_t deepest;
  /// Which of the body's contacts have about the same normal: see FloorGroups.
  std::uint8_t group;
  double distance;
  /// Unit, to the dynamic body.
  double normal[3];
  double point[4][3];
};

}  // namespace winnow
