#include "partitions/structures/cells/cell_layout.kernel.h"
#include "simd/lanes/float_to_uint.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

/// Returns the index of the cell on an axis; the result is the same as that of guess_cell.
Uints number_on(const CellAxis& axis, const Floats& x) {
  const Floats place = (x - axis.origin) * axis.inverse;
  const Floats last = Floats(static_cast<float>(axis.count - 1));
  return float_to_uint(min(max(place, Floats(0.0F)), last));
}

void cells(const float* const* column, const CellAxis* axes, std::size_t begin, std::size_t end,
           std::uint32_t* cell) {
  alignas(64) std::uint32_t number[3][kLanes] = {};
  for (std::size_t row = begin; row < end; row += kLanes) {
    Mask16 suit = bits(Floats::load(column[0] + row) <= Floats::load(column[3] + row));
    for (int speed = 0; speed < 3; ++speed) {
      const CellAxis& axis = axes[speed];
      const Floats low = Floats::load(column[axis.axis] + row);
      suit &= bits(Floats::load(column[3 + axis.axis] + row) - low <= axis.limit);
      if (axis.count > 1) number_on(axis, low).store(number[speed]);
    }
    for (int lane = 0; lane < kLanes; ++lane) {
      const std::uint32_t line = number[2][lane] * axes[1].count + number[1][lane];
      cell[row + static_cast<std::size_t>(lane)] = line * axes[0].count + number[0][lane];
    }
    for (Mask16 left = ~suit & kAllRows; left != 0; left &= left - 1) cell[row + first(left)] = ~0U;
  }
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const CellLayoutKernels WINNOW_KERNEL_TABLE(cell_layout_kernels) = {WINNOW_ISA_NAME::cells};

}  // namespace winnow
