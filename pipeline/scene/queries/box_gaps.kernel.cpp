#include "pipeline/scene/queries/box_gaps.kernel.h"

#include "simd/lanes/boxes.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

void squared_gaps(const float* const* bounds, std::size_t count, const float* low,
                  const float* high, float* out) {
  // The sum of three squares of this is within the range of float.
  const Floats most(1e19F);
  for (std::size_t row = 0; row < count; row += kLanes) {
    const Box16 box = load_slabs<3>(bounds, row);
    Floats sum(0.0F);
    for (int axis = 0; axis < 3; ++axis) {
      const Floats apart =
          max(box.low[axis] - Floats(high[axis]), Floats(low[axis]) - box.high[axis]);
      const Floats gap = min(max(apart, Floats(0.0F)), most);
      sum = sum + gap * gap;
    }
    sum.store(out + row);
  }
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const BoxGapsKernels WINNOW_KERNEL_TABLE(box_gaps_kernels) = {WINNOW_ISA_NAME::squared_gaps};

}  // namespace winnow
