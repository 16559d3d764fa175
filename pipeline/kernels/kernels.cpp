#include "pipeline/kernels/kernels.h"
#include <winnow/simd/isa.h>
#include "pipeline/shapes/pair_order.h"

namespace winnow {

#define WINNOW_DEFINE_PAIR(a, b) WINNOW_DEFINE_KERNELS(NarrowKernels, a##_##b##_kernels)
WINNOW_NARROW_KERNELS(WINNOW_DEFINE_PAIR)
#undef WINNOW_DEFINE_PAIR

const NarrowKernels* narrow_kernels(ShapeKind a, ShapeKind b) noexcept {
  switch (ConvexKindPairs::index(a, b)) {
#define WINNOW_CASE(a, b)                                  \
  case ConvexKindPairs::index(ShapeKind::a, ShapeKind::b): \
    return &a##_##b##_kernels();
    WINNOW_NARROW_KERNELS(WINNOW_CASE)
#undef WINNOW_CASE
    default:
      return nullptr;
  }
}

}  // namespace winnow
