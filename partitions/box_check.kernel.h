#pragma once

#include <winnow/simd/kernels.h>

#include <cstddef>

namespace winnow {

struct BoxCheckKernels {
  /// True if `count` boxes of six floats one after another (min xyz, max xyz) are all legal: min <=
  /// max on every axis, no NaN, not wholly at infinity.
  bool (*boxes)(const float* floats, std::size_t count);
};

WINNOW_KERNELS(BoxCheckKernels, box_check_kernels);

}  // namespace winnow
