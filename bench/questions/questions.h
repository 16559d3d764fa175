#pragma once

#include <winnow/pipeline/narrow_phase.h>
#include "bench/questions/shape_json.h"

namespace winnow::bench {

/// Answers an array of questions, in its order:
/// - {"id", "a": shape, "b": shape} with {"id", "status", "overlap", "distance", "normal",
///   "points", "error_bound"}: points on a and on b, in the axes and from the origin of the world;
/// - {"id", "ray", "target": shape} with {"id", "status", "hit", "t", "normal"}: of a miss, t is
///   "inf" and the normal zero;
/// - {"id", "motion", "min_separation"} with {"id", "status", "hit", "time"}: see motion_json.h.
/// A question that cannot be answered gets its id and the name of its Status and does not keep the
/// others from being answered. An id is whatever the question says, null if it says nothing.
[[nodiscard]] Json answer(const Json& questions, NarrowTier tier);

}  // namespace winnow::bench
