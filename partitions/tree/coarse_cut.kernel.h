#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

inline constexpr std::uint32_t kMostCoarseCells = 64;

/// Cells of about as many points each: the shortest axis is cut into slabs, each of these into
/// lines, and each line into cells. Cells follow each other like a snake.
struct CoarseCells {
  static constexpr std::size_t kPlaces = 128;  // of an axis

  int axis[3] = {};  ///< that is cut into slabs, lines, cells
  float half_low[3] = {};
  float scale[3] = {};
  std::uint32_t cells = 0;
  std::uint8_t slab[kPlaces];
  std::uint8_t line[kMostCoarseCells][kPlaces];  ///< of a slab
  std::uint8_t cell[kMostCoarseCells][kPlaces];  ///< of a line
};

struct CoarseCutKernels {
  /// The least and the greatest of `count` numbers, at least one.
  void (*reach)(const float* x, std::size_t count, float& least, float& greatest);
  /// Plans about `wanted` cells for points on three axes, by a sample of them. False where too many
  /// lie in too little of the range over which all are spread.
  bool (*plan)(const float* const* at, std::size_t count, const float* least, const float* greatest,
               std::uint32_t wanted, CoarseCells& plan);
  /// Writes the cell of each point in [begin, end), and how many points each cell gets.
  void (*assign)(const CoarseCells& plan, const float* const* at, std::size_t begin,
                 std::size_t end, std::uint8_t* cell, std::uint32_t* sizes);
};

WINNOW_KERNELS(CoarseCutKernels, coarse_cut_kernels);

}  // namespace winnow
