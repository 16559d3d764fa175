#pragma once

// Convex shapes given by support functions (user shapes).

#include <winnow/pipeline/shapes.h>

#include <vector>

namespace winnow::test {

/// A box with half extents, a cylinder of radius size[0] and half length size[2], an ellipsoid with
/// radii, or the convex hull of corners.
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
