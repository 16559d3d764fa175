#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Maps object ids to entries of an update: either entry i for id `first` + i, or by a table.
struct EntryOfId {
  std::uint32_t first;
  std::uint32_t ids;                     ///< ids from first + ids on have no entry
  const std::uint32_t* table = nullptr;  ///< by id - first: the entry, ~0 for none
};

struct BoxInputKernels {
  /// True if `count` consecutive boxes of six floats (min xyz, max xyz) are all legal: min <= max
  /// on every axis, no NaN, not wholly at infinity.
  bool (*legal)(const float* floats, std::size_t count);

  /// As above, for `count` given entries.
  bool (*legal_listed)(const float* floats, const std::uint32_t* entry, std::size_t count);

  /// Writes the box of each object (six floats) to its row in [begin, end), infinite ends as
  /// +-FLT_MAX. Rows of objects without an entry stay as they are. `begin` and `end` are multiples
  /// of 16.
  void (*write_rows)(const float* floats, const EntryOfId& entry_of_id, const std::uint32_t* id,
                     float* const* column, std::size_t begin, std::size_t end);

  /// Writes `count` consecutive boxes to the rows from `row` on.
  void (*write_in_order)(const float* floats, std::size_t count, float* const* column,
                         std::size_t row);
};

WINNOW_KERNELS(BoxInputKernels, box_input_kernels);

}  // namespace winnow
