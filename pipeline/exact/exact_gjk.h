#pragma once

#include "pipeline/exact/core_difference.h"
#include "pipeline/exact/exact_overlap.h"

namespace winnow {

/// Where the origin is to the difference of two cores, which is in range, rounded by `rounding`:
/// exactly, never undecided. `direction` is tried first.
[[nodiscard]] ExactVerdict locate_origin(const CoreDifference& difference, const Dyadic& rounding,
                                         const ExactVector& direction) noexcept;

}  // namespace winnow
