#pragma once

// Convex sets that a program gives by their farthest points.

#include <winnow/pipeline/shapes.h>

#include <vector>

namespace winnow::test {

/// A block with half extents, a drum of radius size[0] and half length size[2], an egg with radii,
/// or the hull of corners.
struct OwnSet {
  enum Form { block, drum, egg, corners };

  Form form = block;
  double size[3] = {};
  /// Three numbers each.
  std::vector<double> corner;
};

/// `set` outlives the shape.
[[nodiscard]] SupportShape shape_of(const OwnSet& set, double rounding);

}  // namespace winnow::test
