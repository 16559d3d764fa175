#pragma once

#include <winnow/core/status.h>
#include "bench/common/json.h"

namespace winnow::bench {

/// Answers {"motion": {"kind": "vertex_face" or "edge_edge", "start": four points, "end": four
/// points}, "min_separation"}, the separation being 0 where it is missing, with "status", "hit" and
/// "time" ("inf" without a hit): a vertex and its face's corners, or the ends of one edge and of
/// the other, all of which move linearly from time 0 to 1. Numbers may also be strings of C's
/// hexadecimal notation, as "-0x1.8p+1", exact to the last bit. Writes nothing unless `ok`:
/// `invalid_argument` where a member is missing or of the wrong type, else what `feature_impact`
/// says.
[[nodiscard]] Status answer_motion(const Json& question, Json& answer);

}  // namespace winnow::bench
