#pragma once

#include "partitions/structures/levels/hierarchical_grid.kernel.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Octaves of a longest edge: its power of two; 0 if it has next to no length.
inline constexpr std::uint32_t kOctaves = 256;
/// Of rows that are empty, or have an edge of `kUnboundedEdge` and more.
inline constexpr std::uint32_t kNoOctave = kOctaves - 1;
inline constexpr float kUnboundedEdge = 1e30F;

/// How rows are sorted into levels, and those of a level into its cells. Columns of boxes are
/// readable to the next multiple of 16 after the last row.
struct LevelRowsKernels {
  /// Writes the octave of each row of [begin, end), of which `begin` is a multiple of 16; there is
  /// room to the next one after `end`.
  void (*octaves)(const float* const* boxes, std::size_t begin, std::size_t end,
                  std::uint32_t* octave);
  /// Makes `longest` the longest edges, on each axis, of the boxes of rows[begin, end).
  void (*longest)(const float* const* boxes, const std::uint32_t* rows, std::size_t begin,
                  std::size_t end, float* longest);
  /// Writes for rows[begin, end) the line above the lowest `step_bits` and the step of the line in
  /// those, above 32 bits of the row. The line is left out if `step_only`.
  void (*places)(const GridLevel&, const float* const* boxes, const std::uint32_t* rows,
                 std::size_t begin, std::size_t end, unsigned step_bits, bool step_only,
                 std::uint64_t* items);
};

WINNOW_KERNELS(LevelRowsKernels, level_rows_kernels);

}  // namespace winnow
