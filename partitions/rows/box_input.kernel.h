#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Which of many boxes an object has: those of ids from `first` on, one for each or by a table.
struct BoxOfId {
  std::uint32_t first;
  std::uint32_t ids;                     ///< further ids have none
  const std::uint32_t* table = nullptr;  ///< by id - first: number of its box, ~0 if it has none
};

struct BoxInputKernels {
  /// True if `count` boxes of six floats one after another (min xyz, max xyz) are all legal: min <=
  /// max on every axis, no NaN, not wholly at infinity.
  bool (*legal)(const float* floats, std::size_t count);

  /// The same of the boxes that `count` numbers name.
  bool (*legal_listed)(const float* floats, const std::uint32_t* number, std::size_t count);

  /// Gives each row of [begin, end) the box that its object has, of six floats each, ends at
  /// infinity as +-FLT_MAX; rows of objects without one stay as they are. Both ends are multiples
  /// of 16; ids are readable for 32 rows more.
  void (*write_rows)(const float* floats, const BoxOfId& box_of, const std::uint32_t* id,
                     float* const* column, std::size_t begin, std::size_t end);

  /// Gives rows from `row` on `count` boxes, one after another.
  void (*write_in_order)(const float* floats, std::size_t count, float* const* column,
                         std::size_t row);

  /// Sets the bits in `words` of those of `count` boxes that lie within the stored ones, where
  /// these are larger by at most twice the margin distance + share * longest finite edge. Columns
  /// of lower, then of upper ends, readable to the next multiple of 16; further bits are undefined.
  void (*within)(const float* const* given, const float* const* stored, std::size_t count,
                 float distance, float share, std::uint64_t* words);

  /// Copies `count` boxes of six floats each to `to`, and writes the numbers of those that have an
  /// end further than `margin` from the same end in `near` to `left`; returns how many these are.
  /// It stops behind the 16 boxes with which there are more than `most`, for which and 16 more
  /// there is room.
  std::uint32_t (*copy_near)(const float* boxes, const float* near, float* to, std::size_t count,
                             float margin, std::uint32_t* left, std::uint32_t most);

  /// Writes the numbers of those of `count` boxes of six floats each that do not lie within a box
  /// of six floats to `out`, which has room for all; returns how many these are.
  std::uint32_t (*beyond)(const float* boxes, const float* around, std::size_t count,
                          std::uint32_t* out);
};

WINNOW_KERNELS(BoxInputKernels, box_input_kernels);

}  // namespace winnow
