#pragma once

#include "pipeline/solver/core.h"

#include <limits>

namespace winnow::impact {

/// Axes that differ by less count as equal; the difference is covered by the noise.
inline constexpr double kSameAxis = 16.0 * std::numeric_limits<double>::epsilon();

/// Returns an upper bound on the distance of a core's points from the axis w through its center; 0
/// for a half-space. The core must not be rotated.
[[nodiscard]] double reach_about(const solver::Core& core, const solver::Vec& w) noexcept;

/// Returns whether rotation about the axis w leaves the core unchanged. The core must not be
/// rotated.
[[nodiscard]] bool is_invariant(const solver::Core& core, const solver::Vec& w) noexcept;

/// About half of the core's diameter, plus its rounding; 0 for a half-space.
[[nodiscard]] double extent(const solver::Core& core) noexcept;

}  // namespace winnow::impact
