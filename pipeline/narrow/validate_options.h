#pragma once

// Checks and kernel selection shared by NarrowPhase::collide and collide() of one pair.

#include <winnow/pipeline/narrow_phase.h>
#include "pipeline/kernels/kernels.h"

#include <algorithm>
#include <cmath>

namespace winnow {

[[nodiscard]] inline bool are_valid(const NarrowOptions& options) noexcept {
  const bool has_level =
      options.level >= ContactLevel::boolean && options.level <= ContactLevel::manifold;
  const auto is_length = [](double margin) { return std::isfinite(margin) && margin >= 0.0; };
  return has_level && is_length(options.contact_margin) &&
         std::ranges::all_of(options.contact_margins, is_length);
}

[[nodiscard]] inline bool has_shape(const ShapeTables& tables, ShapeId shape) noexcept {
  const std::uint32_t kind = shape.kind_index();
  return kind < kShapeKinds && shape.index() < tables.count[kind];
}

/// The kernel for pairs of two kinds, a <= b; null if the solver must answer.
[[nodiscard]] inline NarrowKernel kernel_for(ShapeKind a, ShapeKind b,
                                             const NarrowOptions& options) noexcept {
  const NarrowKernels* const kernels = narrow_kernels(a, b);
  if (kernels == nullptr || options.tier == NarrowTier::reference) return nullptr;
  return kernels->of_level[kernel_index(options.level)];
}

}  // namespace winnow
