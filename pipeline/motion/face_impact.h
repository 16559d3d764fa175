#pragma once

#include "pipeline/motion/body_impact.h"

#include <array>

namespace winnow::impact {

/// A triangle each of whose corners moves linearly, in time from 0 to 1.
struct MovingFace {
  std::array<Vec, 3> start;
  std::array<Vec, 3> end;
  /// Added all around.
  double rounding = 0.0;
};

/// The first impact of a body, which is `a`, and a face; as `find_body_impact`.
[[nodiscard]] BodyImpact find_face_impact(const PartTraversal& parts, const MovingBody& body,
                                          const MovingFace& face, double tolerance);

}  // namespace winnow::impact
