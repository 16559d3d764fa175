#pragma once

#include "pipeline/exact/core_difference.h"
#include "pipeline/exact/exact_overlap.h"

namespace winnow {

/// Where the origin is to the difference of two cores rounded by `rounding`, decided exactly.
/// `direction` is tried first. `undecided` only beyond a bound of iterations that nothing known
/// comes near.
[[nodiscard]] ExactVerdict locate_origin(const CoreDifference& difference, const Dyadic& rounding,
                                         const ExactVector& direction) noexcept;

}  // namespace winnow
