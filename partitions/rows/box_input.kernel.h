#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Maps object ids to boxes: either box i for id `first` + i, or by a table.
struct BoxOfId {
  std::uint32_t first;
  std::uint32_t ids;                     ///< ids from first + ids on have no box
  const std::uint32_t* table = nullptr;  ///< by id - first: index of the box, ~0 for none
};

struct BoxInputKernels {
  /// True if `count` consecutive boxes of six floats (min xyz, max xyz) are all legal: min <= max
  /// on every axis, no NaN, not wholly at infinity.
  bool (*legal)(const float* floats, std::size_t count);

  /// As above, for the boxes with `count` given indices.
  bool (*legal_listed)(const float* floats, const std::uint32_t* number, std::size_t count);

  /// Writes the box of each object (six floats) to its row in [begin, end), infinite ends as
  /// +-FLT_MAX. Rows of objects without a box stay as they are. `begin` and `end` are multiples
  /// of 16.
  void (*write_rows)(const float* floats, const BoxOfId& box_of, const std::uint32_t* id,
                     float* const* column, std::size_t begin, std::size_t end);

  /// Writes `count` consecutive boxes to the rows from `row` on.
  void (*write_in_order)(const float* floats, std::size_t count, float* const* column,
                         std::size_t row);

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

WINNOW_KERNELS(BoxInputKernels, box_input_kernels);

}  // namespace winnow
