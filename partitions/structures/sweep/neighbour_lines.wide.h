#pragma once

#include "partitions/structures/cells/cell_axis.h"
#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// Lines of cells (or strips) lie on two axes, line = slow * mids + mid. Those after a line whose
/// objects can touch its own: each pair of neighbours is met from one side only.
struct NeighbourLines {
  std::uint32_t line[4];
  int count = 0;

  NeighbourLines(const CellAxis& mid_axis, const CellAxis& slow_axis, std::uint32_t own) {
    const std::uint32_t mids = mid_axis.count;
    const std::uint32_t mid = own % mids;
    if (mid + 1 < mids) line[count++] = own + 1;
    if (own / mids + 1 == slow_axis.count) return;
    if (mid > 0) line[count++] = own + mids - 1;
    line[count++] = own + mids;
    if (mid + 1 < mids) line[count++] = own + mids + 1;
  }
};

}  // namespace winnow::WINNOW_ISA_NAME
