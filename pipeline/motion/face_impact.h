#pragma once

#include "pipeline/motion/body_impact.h"

#include <array>

namespace winnow::impact {

/// A triangle whose corners move linearly over time 0 to 1.
struct MovingFace {
  std::array<Vec, 3> start;
  std::array<Vec, 3> end;
  /// Rounding radius added to the triangle.
  double rounding = 0.0;
};

/// Finds the first impact of a body (a) and a face (b) from time 0 to 1. Requirements are as for
/// `find_body_impact`.
[[nodiscard]] BodyImpact find_face_impact(const SubShapeQuery& parts, const MovingBody& body,
                                          const MovingFace& face, double tolerance);

}  // namespace winnow::impact
