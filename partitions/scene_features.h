#pragma once

#include <winnow/core/export.h>

#include <array>
#include <cstddef>

namespace winnow {

/// What a sample of the boxes tells of a scene: enough to predict what a structure would cost. The
/// same on every machine.
struct SceneFeatures {
  std::size_t objects = 0;  ///< that the sample stands for
  /// By axis: where the middle 96 % of the objects lie, in units of their mean edge on this axis.
  /// An axis with little room prunes nothing.
  std::array<double, 3> room{};
  /// log2 of a large object's longest edge over a small one's (95th and 5th percentile): 0 where
  /// all are of one size.
  double size_spread = 0.0;
  /// log2 of how much likelier than in an even scene two objects lie in the same of 64 cells: 0 if
  /// even, up to 6. Simpson's index of the sample, its own pairs of one left out.
  double crowding = 0.0;
  /// Pairs per object, if the scene were even but for its crowding; at most 16.
  double pairs = 0.0;
};

}  // namespace winnow
