#pragma once

// Convex shapes given by support functions (user shapes).

#include <winnow/pipeline/shapes.h>

#include <vector>

namespace winnow::test {

/// By `form`: a box with half extents `size`, a cylinder of radius size[0] and half length size[2],
/// an ellipsoid with radii `size`, or the convex hull of `corner`.
struct UserShape {
  enum Form { block, drum, egg, corners };

  Form form = block;
  double size[3] = {};
  /// Three coordinates per corner.
  std::vector<double> corner;
};

/// `set` must outlive the shape.
[[nodiscard]] SupportShape shape_of(const UserShape& set, double rounding);

}  // namespace winnow::test
