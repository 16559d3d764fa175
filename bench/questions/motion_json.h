#pragma once

#include <winnow/core/status.h>
#include "bench/common/json.h"

namespace winnow::bench {

/// Answers a continuous collision query of two features that move linearly from time 0 to 1:
///   {"motion": {"kind": "vertex_face" or "edge_edge", "start": four points, "end": four points},
///    "min_separation": number, 0 if missing}
/// The points are a vertex and its face's corners, or the ends of one edge and of the other. Writes
/// "status", "hit" and "time" ("inf" without a hit). A number may also be a string in C's
/// hexadecimal notation such as "-0x1.8p+1", which is exact to the last bit. Returns
/// `invalid_argument` if a member is missing or of the wrong type, else the status of
/// `feature_impact`. Writes nothing unless the status is `ok`.
[[nodiscard]] Status answer_motion(const Json& question, Json& answer);

/// Reads a number as `read_number` does, or a string in C's hexadecimal notation.
[[nodiscard]] bool read_exact_number(const Json& value, double& out);

}  // namespace winnow::bench
