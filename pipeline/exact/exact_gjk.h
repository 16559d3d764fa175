#pragma once

#include "pipeline/exact/core_difference.h"
#include "pipeline/exact/exact_overlap.h"

namespace winnow {

/// Locates the origin relative to the Minkowski difference of two cores, dilated by `rounding`.
/// Exact, never undecided. Requires difference.in_range(). `direction` is the first search
/// direction.
[[nodiscard]] ExactVerdict locate_origin(const CoreDifference& difference, const Dyadic& rounding,
                                         const ExactVector& direction) noexcept;

}  // namespace winnow
