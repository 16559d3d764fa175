#pragma once

// Makes a program contain only the kernels of the kinds of shapes that it creates. The function
// that creates a shape of a kind (pipeline/kinds/) links the kernels of the pairs of that kind with
// itself and with all kinds before it in the order below; nothing else refers to the kernels.
//
// The order: sphere, box, half_space, capsule, triangle, hull, cylinder, cone, ellipsoid,
// tapered_capsule, support.

#include "pipeline/kernels/kernels.h"

namespace winnow {

/// Registers the kernels of a pair kind, a <= b, for narrow_kernels(). Thread-safe.
void link_kernels(ShapeKind a, ShapeKind b, const NarrowKernels& (*kernels)() noexcept) noexcept;

/// Links the kernels of triangles, for the primitives of composite shapes, which are in no pool.
void link_triangle_kernels() noexcept;
/// Links the kernels of hulls, for convex solids, which are in no pool of convex shapes.
void link_hull_kernels() noexcept;

}  // namespace winnow

/// For the file of a kind: defines `link_kernels_of_<kind>()`, which links the kernels of the pairs
/// that WINNOW_PAIRS(WINNOW_X) lists as WINNOW_X(a, b).
#define WINNOW_DEFINE_LINK(kind, WINNOW_PAIRS) \
  WINNOW_PAIRS(WINNOW_DEFINE_PAIR_KERNELS)     \
  namespace {                                  \
  void link_kernels_of_##kind() noexcept {     \
    WINNOW_PAIRS(WINNOW_LINK_PAIR)             \
  }                                            \
  }
#define WINNOW_DEFINE_PAIR_KERNELS(a, b) WINNOW_DEFINE_KERNELS(NarrowKernels, a##_##b##_kernels)
#define WINNOW_LINK_PAIR(a, b) link_kernels(ShapeKind::a, ShapeKind::b, a##_##b##_kernels);
