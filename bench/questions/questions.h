#pragma once

#include <winnow/pipeline/narrow_phase.h>
#include "bench/questions/shape_json.h"

namespace winnow::bench {

/// Answers an array of questions, in its order:
/// - {"id", "a": shape, "b": shape} with {"id", "status", "overlap", "distance", "normal",
///   "points", "error_bound"}: points on a and on b, in world coordinates. `contacts` adds
///   "manifolds", the contact regions of the two bodies: {"normal", "distance", "points":
///   [{"position", "depth"}]}, with normals from a to b. They are as near as the "contact_margin"
///   of the question, 0 if it is missing;
/// - pairs of which a shape has an "end_pose" with {"id", "status", "hit", "time", "gap", "normal",
///   "points", "error_bound"}: its time of impact;
/// - {"id", "ray", "target": shape} with {"id", "status", "hit", "t", "normal"}: for a miss, t is
///   "inf" and the normal zero;
/// - {"id", "motion": {"kind", "start", "end"}, "min_separation"} with {"id", "status", "hit",
///   "time"}: the impact of two features that move linearly from time 0 to 1. A number may also be
///   a string in C's hexadecimal notation such as "-0x1.8p+1", which is exact to the last bit.
/// If a question is invalid, its answer has only the id and the name of its Status, and the other
/// questions are still answered. The id is copied from the question, or null if it has none.
[[nodiscard]] Json answer(const Json& questions, NarrowTier tier, bool contacts = false);

}  // namespace winnow::bench
