#pragma once

#include <winnow/core/export.h>

#include <array>
#include <cstddef>

namespace winnow {

/// Features of a scene, estimated from a sample of its boxes: input for the prediction of a
/// structure's cost. Equal on every machine.
struct SceneFeatures {
  std::size_t objects = 0;  ///< objects in the scene
  /// Per axis, the range of the middle 96 % of the objects divided by their mean edge on this axis.
  /// An axis with a small value prunes nothing.
  std::array<double, 3> room{};
  /// log2 of the ratio of longest edges between a large and a small object (95th and 5th
  /// percentile); 0 if all sizes are equal.
  double size_spread = 0.0;
  /// How strongly objects cluster: log2 of (probability that two sampled objects are in the same of
  /// 64 cells) / (the same probability in an even scene). 0 if even, at most 6. The probability is
  /// Simpson's index without pairs of an object with itself.
  double crowding = 0.0;
  /// Estimated pairs per object: the number in an even distribution times the factor by which
  /// objects cluster; at most 16.
  double pairs = 0.0;
};

}  // namespace winnow
