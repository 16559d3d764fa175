#pragma once

#include "partitions/rows/row_view.h"

#include <cstdint>

namespace winnow {

/// What kernels do with rows in cells. `View` holds the rows, as `rows`, and where cells begin;
/// places are cells, or lines of them, and units those that `self_pairs` of a structure goes by.
template <typename View>
struct CellKernels {
  /// All pairs of the rows of units [begin, end) with each other and with rows behind them.
  bool (*self_pairs)(const View&, std::uint32_t begin, std::uint32_t end, PairSink&);
  /// All hits of the batch's boxes.
  bool (*query)(const View&, const QueryBatch&, PairSink&);
  /// Writes to `out` the rows of places [begin, end) that left theirs, place by place; returns how
  /// many.
  std::uint32_t (*find_misfits)(const View&, std::uint32_t begin, std::uint32_t end,
                                std::uint32_t* out);
};

/// One axis of a grid or of strips, for kernels. A regular object of cell c has the lower end of
/// its box within [from[c], to[c]] (cells overlap by twice the slack that objects may drift by) and
/// an edge, as floats subtract, of at most `limit`; the true edge is then at most `reach`. These
/// tables define the cells: no rounding can put an object elsewhere. from[0] is -infinity and
/// to[count - 1] is +infinity.
struct CellAxis {
  const float* from = nullptr;
  const float* to = nullptr;
  std::uint32_t count = 1;
  std::uint32_t axis = 0;  ///< 0, 1, 2 for x, y, z
  float origin = 0.0F;     ///< start of cell 0, for guess_cell
  float inverse = 0.0F;    ///< cells per unit length, for guess_cell; 0 if there is but one
  float reach = 0.0F;
  float limit = 0.0F;
};

/// A cell that holds an object with its lower end at x, if its edge is no longer than the limit. It
/// never falls as x grows.
static inline std::uint32_t guess_cell(const CellAxis& a, float x) {
  const float t = (x - a.origin) * a.inverse;
  const float last = static_cast<float>(a.count - 1);
  return static_cast<std::uint32_t>(t > 0.0F ? (t < last ? t : last) : 0.0F);
}

/// The first cell that may hold an object with its lower end at or above x.
static inline std::uint32_t first_cell(const CellAxis& a, float x) {
  std::uint32_t c = guess_cell(a, x);
  while (c > 0 && a.to[c - 1] >= x) --c;
  while (a.to[c] < x) ++c;
  return c;
}

/// The last cell that may hold an object with its lower end at or below x.
static inline std::uint32_t last_cell(const CellAxis& a, float x) {
  std::uint32_t c = guess_cell(a, x);
  while (c + 1 < a.count && a.from[c + 1] <= x) ++c;
  while (a.from[c] > x) --c;
  return c;
}

}  // namespace winnow
