#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Comparisons of given boxes with other boxes.
struct BoxCompareKernels {
  /// Sets bit i of `words` if given box i is within stored box i, and the stored box is at most
  /// four margins longer on each axis. The margin is `distance` + `share` * longest finite edge of
  /// the given box. Columns contain lower, then upper ends and are readable to the next multiple of
  /// 16; bits beyond `count` are undefined.
  void (*within)(const float* const* given, const float* const* stored, std::size_t count,
                 float distance, float share, std::uint64_t* words);

  /// Copies `count` boxes of six floats to `to`. Writes the index of each box with an end further
  /// than `skin` from the same end in `near` to `departed`, and returns their number. Stops after
  /// the group of 16 boxes with which the number exceeds `most`. `departed` has room for `most` +
  /// 32 indices.
  std::uint32_t (*copy_near)(const float* boxes, const float* near, float* to, std::size_t count,
                             float skin, std::uint32_t* departed, std::uint32_t most);

  /// Writes the index of each of `count` boxes (six floats) that is not within the box `around` to
  /// `out`, which has room for all; returns their number.
  std::uint32_t (*beyond)(const float* boxes, const float* around, std::size_t count,
                          std::uint32_t* out);
};

WINNOW_KERNELS(BoxCompareKernels, box_compare_kernels);

}  // namespace winnow
