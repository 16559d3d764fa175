#pragma once

#include <winnow/pipeline/narrow_phase.h>

#include <string>

#include "query/shape_json.h"

namespace winnow::bench {

/// Hard cases are questions whose answers are known by reasoning, as `winnow query` takes them,
/// with one more member: "expect" holds a "status" other than ok, or what the answer is: "overlap",
/// "distance" and "normal" (where it is unique) of a pair, "hit", "t" and "normal" of a ray, with a
/// "tolerance" where these had to be rounded by more than doubles are.

/// What is wrong with the answer to a hard case; empty if nothing is: the id, the status, the
/// verdict, the distance (within what the tier promises), the error bound, or a normal that is not
/// unit or more than 0.01 degrees off. `sign` is -1 where a and b were exchanged, which turns the
/// normal.
[[nodiscard]] std::string fault(const Json& question, const Json& answer, NarrowTier tier,
                                double sign = 1.0);

}  // namespace winnow::bench
