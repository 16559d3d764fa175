#pragma once

#include "partitions/structures/levels/hierarchical_grid.kernel.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Number of octaves. The octave of an object is the biased exponent of its longest edge as a
/// float; 0 for an edge that is 0 or denormal.
inline constexpr std::uint32_t kOctaves = 256;
/// The octave of empty rows and of rows with an edge of at least `kUnboundedEdge`.
inline constexpr std::uint32_t kNoOctave = kOctaves - 1;
inline constexpr float kUnboundedEdge = 1e30F;

/// Kernels that sort rows into levels and into the cells of a level. Columns of boxes are readable
/// to the next multiple of 16 after the last row.
struct LevelRowsKernels {
  /// Writes the octave of each row of [begin, end). `begin` is a multiple of 16; `octave` is
  /// writable to the next multiple of 16 after `end`.
  void (*octaves)(const float* const* boxes, std::size_t begin, std::size_t end,
                  std::uint32_t* octave);
  /// Sets `longest` to the longest edge, on each axis, of the boxes of rows[begin, end).
  void (*longest)(const float* const* boxes, const std::uint32_t* rows, std::size_t begin,
                  std::size_t end, float* longest);
  /// Writes one item per row of rows[begin, end): the row in the low 32 bits, above it the step in
  /// `step_bits` bits, and above that the line. The line is 0 if `step_only`.
  void (*places)(const GridLevel&, const float* const* boxes, const std::uint32_t* rows,
                 std::size_t begin, std::size_t end, unsigned step_bits, bool step_only,
                 std::uint64_t* items);
};

WINNOW_KERNELS(LevelRowsKernels, level_rows_kernels);

}  // namespace winnow
