#include <winnow/pipeline/narrow/kernels.h>
#include <winnow/simd/real.wide.h>

namespace winnow {

extern const NarrowKernels WINNOW_KERNEL_TABLE(hull_hull_kernels) = {};

}  // namespace winnow
