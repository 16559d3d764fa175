#include <winnow/partitions/box_check.kernel.h>
#include <winnow/simd/wide.h>

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

constexpr std::size_t kFloats = 6;

bool box_is_legal(const float* f, float infinity) {
  for (int axis = 0; axis < 3; ++axis) {
    const float low = f[axis];
    const float high = f[3 + axis];
    if (!(low <= high && low < infinity && high > -infinity)) return false;
  }
  return true;
}

/// Sixteen boxes are 96 floats. Against the same floats three places on, each lower end meets its
/// upper end; the other lanes are left out.
bool boxes(const float* floats, std::size_t count) {
  const float infinity = __builtin_inff();
  // The largest finite float: compared by <= it does what < infinity does.
  const Float16 most = broadcast(__FLT_MAX__);
  const Float16 least = broadcast(-__FLT_MAX__);
  constexpr Mask16 kLower[3] = {0x71C7U, 0xC71CU, 0x1C71U};
  std::size_t i = 0;
  // One box short of the end, because the shifted loads run three floats over.
  for (; i + kLanes < count; i += kLanes) {
    Mask16 bad = 0;
    for (unsigned part = 0; part < kFloats; ++part) {
      const float* p = floats + i * kFloats + part * kLanes;
      const Float16 low = load_unaligned(p);
      const Float16 high = load_unaligned(p + 3);
      const Mask16 good = less_equal(low, high) & less_equal(low, most) & less_equal(least, high);
      bad |= kLower[part % 3] & ~good;
    }
    if (bad != 0) return false;
  }
  for (; i < count; ++i) {
    if (!box_is_legal(floats + i * kFloats, infinity)) return false;
  }
  return true;
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const BoxCheckKernels WINNOW_KERNEL_TABLE(box_check_kernels) = {WINNOW_ISA_NAME::boxes};

}  // namespace winnow
