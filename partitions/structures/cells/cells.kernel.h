#pragma once

#include "partitions/rows/row_view.h"

#include <cstdint>

namespace winnow {

/// Kernels for rows in cells. `View` contains the rows, as `rows`, and the starts of cells. Places
/// are cells or lines of cells; the units of `self_pairs` are defined by each structure.
template <typename View>
struct CellKernels {
  /// Finds all pairs of the rows of units [begin, end) with each other and with rows behind them.
  bool (*self_pairs)(const View&, std::uint32_t begin, std::uint32_t end, PairSink&);
  /// Finds all hits of the batch's boxes.
  bool (*query)(const View&, const QueryBatch&, PairSink&);
  /// Writes the rows of places [begin, end) that no longer fit their place to `out`, place by
  /// place; returns their number.
  std::uint32_t (*find_misfits)(const View&, std::uint32_t begin, std::uint32_t end,
                                std::uint32_t* out);
};

/// One axis of a grid or of strips, for kernels. A regular object of cell c has its lower bound
/// within [from[c], to[c]]; adjacent cells overlap by twice the slack within which objects may
/// drift. The edge of the object, computed in float, is at most `limit`; the exact edge is then at
/// most `reach`. These tables define the cells, so rounding cannot put an object in another cell.
/// from[0] is -infinity and to[count - 1] is +infinity.
struct CellAxis {
  const float* from = nullptr;
  const float* to = nullptr;
  std::uint32_t count = 1;
  std::uint32_t axis = 0;  ///< 0, 1, 2 for x, y, z
  float origin = 0.0F;     ///< start of cell 0, for guess_cell
  float inverse = 0.0F;    ///< cells per unit length, for guess_cell; 0 if there is only one cell
  float reach = 0.0F;
  float limit = 0.0F;
};

/// Returns a cell for an object with lower bound x, if its edge is within the limit. The result is
/// monotonic in x.
static inline std::uint32_t guess_cell(const CellAxis& a, float x) {
  const float t = (x - a.origin) * a.inverse;
  const float last = static_cast<float>(a.count - 1);
  return static_cast<std::uint32_t>(t > 0.0F ? (t < last ? t : last) : 0.0F);
}

/// Returns the first cell that may contain an object with a lower bound >= x.
static inline std::uint32_t first_cell(const CellAxis& a, float x) {
  std::uint32_t c = guess_cell(a, x);
  while (c > 0 && a.to[c - 1] >= x) --c;
  while (a.to[c] < x) ++c;
  return c;
}

/// Returns the last cell that may contain an object with a lower bound <= x.
static inline std::uint32_t last_cell(const CellAxis& a, float x) {
  std::uint32_t c = guess_cell(a, x);
  while (c + 1 < a.count && a.from[c + 1] <= x) ++c;
  while (a.from[c] > x) --c;
  return c;
}

}  // namespace winnow
