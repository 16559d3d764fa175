#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

inline constexpr std::uint32_t kMaxCoarseCells = 64;

/// Cells with about equal numbers of points: the shortest axis is cut into slabs, slabs into lines,
/// and lines into cells. Alternate rows run backwards, so that successive cells are neighbours.
struct CoarseCells {
  static constexpr std::size_t kPlaces = 128;  // per axis

  int axis[3] = {};  ///< the axes of slabs, lines and cells
  float half_low[3] = {};
  float scale[3] = {};
  std::uint32_t cells = 0;
  std::uint8_t slab[kPlaces];
  std::uint8_t line[kMaxCoarseCells][kPlaces];  ///< by slab
  std::uint8_t cell[kMaxCoarseCells][kPlaces];  ///< by line
};

struct CoarseCutKernels {
  /// Computes the minimum and maximum of `count` >= 1 numbers.
  void (*reach)(const float* x, std::size_t count, float& least, float& greatest);
  /// Plans about `target_cells` cells for points on three axes, from a sample of the points.
  /// Returns false if too many points are in too small a part of their range.
  bool (*plan)(const float* const* at, std::size_t count, const float* least, const float* greatest,
               std::uint32_t target_cells, CoarseCells& plan);
  /// Writes the cell of each point in [begin, end), and the number of points of each cell.
  void (*assign)(const CoarseCells& plan, const float* const* at, std::size_t begin,
                 std::size_t end, std::uint8_t* cell, std::uint32_t* sizes);
};

WINNOW_KERNELS(CoarseCutKernels, coarse_cut_kernels);

}  // namespace winnow
