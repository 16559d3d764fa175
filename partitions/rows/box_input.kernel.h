#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

struct BoxInputKernels {
  /// True if `count` boxes of six floats one after another (min xyz, max xyz) are all legal: min <=
  /// max on every axis, no NaN, not wholly at infinity.
  bool (*legal)(const float* floats, std::size_t count);

  /// Gives each row of [begin, end) the box that its object has among `count` boxes of objects
  /// `first` on, ends at infinity as +-FLT_MAX; rows of other objects, or of none, stay as they
  /// are. Both ends are multiples of 16; ids are readable for 32 rows more.
  void (*write_rows)(const float* floats, std::uint32_t first, std::uint32_t count,
                     const std::uint32_t* id, float* const* column, std::size_t begin,
                     std::size_t end);

  /// Gives rows from `row` on `count` boxes, one after another.
  void (*write_in_order)(const float* floats, std::size_t count, float* const* column,
                         std::size_t row);

  /// Sets the bits in `words` of those of `count` boxes that lie within the stored ones, where
  /// these are larger by at most twice the margin distance + share * longest finite edge. Columns
  /// of lower, then of upper ends, readable to the next multiple of 16; further bits are undefined.
  void (*within)(const float* const* given, const float* const* stored, std::size_t count,
                 float distance, float share, std::uint64_t* words);
};

WINNOW_KERNELS(BoxInputKernels, box_input_kernels);

}  // namespace winnow
