#pragma once

#include <cstdint>

namespace winnow {

/// A manifold of a dynamic body with a fixed one, in world axes, relative to the dynamic body's
/// position.
struct FloorContact {
  enum class Source : std::uint8_t { convex, part, region, dropped };

  std::uint32_t body;
  std::uint32_t floor;
  /// Index of the pair in PairBatch::convex or PairBatch::composite.
  std::uint32_t pair;
  /// Index of the result in its source.
  std::uint32_t answer;
  Source source;
  /// Number of points, which are on the fixed body's surface, and the index of the deepest one.
  std::uint8_t count;
  std::uint8_t deepest;
  /// Group of the body's contacts that have about the same normal: see FloorGroups.
  std::uint8_t group;
  double distance;
  /// Unit vector towards the dynamic body.
  double normal[3];
  double point[4][3];
};

}  // namespace winnow
