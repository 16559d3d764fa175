#include <winnow/pipeline/narrow/kernels.h>
#include <winnow/simd/real.wide.h>

namespace winnow {

extern const NarrowKernels WINNOW_KERNEL_TABLE(sphere_sphere_kernels) = {};

}  // namespace winnow
