#pragma once

// How a program gets the kernels of those kinds of shapes alone that it makes: what makes a shape
// of a kind (pipeline/kinds/) links the kernels of its pairs with itself and with all kinds before
// it in that order, and nothing else names them.
//
// The order: sphere, box, half_space, capsule, triangle, hull, cylinder, cone, ellipsoid,
// tapered_capsule, support.

#include "pipeline/kernels/kernels.h"

namespace winnow {

/// From now on narrow_kernels knows those of a pair kind, a <= b.
void link_kernels(ShapeKind a, ShapeKind b, const NarrowKernels& (*kernels)() noexcept) noexcept;

}  // namespace winnow

/// In the file of a kind: defines `link_kernels_of_<kind>()`, which links those of the pairs that
/// WINNOW_PAIRS(WINNOW_X) names as WINNOW_X(a, b).
#define WINNOW_DEFINE_LINK(kind, WINNOW_PAIRS) \
  WINNOW_PAIRS(WINNOW_DEFINE_PAIR_KERNELS)     \
  namespace {                                  \
  void link_kernels_of_##kind() noexcept {     \
    WINNOW_PAIRS(WINNOW_LINK_PAIR)             \
  }                                            \
  }
#define WINNOW_DEFINE_PAIR_KERNELS(a, b) WINNOW_DEFINE_KERNELS(NarrowKernels, a##_##b##_kernels)
#define WINNOW_LINK_PAIR(a, b) link_kernels(ShapeKind::a, ShapeKind::b, a##_##b##_kernels);
