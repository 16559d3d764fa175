// Searches a height field's tile pyramid: finds all triangles whose boxes overlap a box, or visits
// triangles roughly in order of the time of a moving box or of distance.
// composites/primitive_pair_search.cpp and composites/composite_traversal.cpp call these functions.

#include "pipeline/mesh/box_measures.h"
#include "pipeline/mesh/height_grid.h"
#include "pipeline/shapes/frame.h"

#include <algorithm>

namespace winnow {
namespace {

using mid::kInfinity;
struct GridBox {
  double low[3];
  double high[3];
};

/// The squares [first, end) that overlap [min, max] along an axis. The quotient may be off by one,
/// so the result is corrected by comparisons with the ends of squares, which are computed as for
/// triangles.
struct SquareRange {
  std::uint32_t first = 0;
  std::uint32_t end = 0;

  SquareRange(double min, double max, double spacing, std::uint32_t count) {
    const double length = count * spacing;
    if (!(min <= length && max >= 0.0)) return;
    const auto guess = [&](double x) {
      return static_cast<std::uint32_t>(std::clamp(x / spacing, 0.0, static_cast<double>(count)));
    };
    first = guess(min);
    while (first > 0 && first * spacing >= min) --first;
    while ((first + 1.0) * spacing < min) ++first;
    end = guess(max);
    while (end < count && end * spacing <= max) ++end;
    while (end > 0 && (end - 1.0) * spacing > max) --end;
  }
};

/// Height ranges of the two triangles of a square.
struct SquareHeights {
  float low[2];
  float high[2];

  /// Returns false if the square is a hole.
  [[nodiscard]] bool read(const HeightGrid& grid, std::uint32_t column, std::uint32_t row) {
    float h[4];
    grid.corners(column, row, h);
    // NaN does not equal itself.
    if (!(h[0] == h[0] && h[1] == h[1] && h[2] == h[2] && h[3] == h[3])) return false;
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min({h[0], h[3], h[1 + k]});
      high[k] = std::max({h[0], h[3], h[1 + k]});
    }
    return true;
  }
};

/// The box of squares [column, last_column) x [row, last_row), with heights 0.
GridBox floor_box(const HeightGrid& grid, std::uint32_t column, std::uint32_t row,
                  std::uint32_t last_column, std::uint32_t last_row) {
  return {{column * grid.spacing[0], row * grid.spacing[1], 0.0},
          {last_column * grid.spacing[0], last_row * grid.spacing[1], 0.0}};
}

/// Measures the time at which a moving box first touches a box; infinite if it does not up to the
/// limit.
struct GridCast {
  const double* min;
  const double* max;
  const double* direction;
  double limit;

  [[nodiscard]] double measure(const GridBox& box) const {
    return moving_box_time(min, max, direction, limit, box.low, box.high);
  }
  [[nodiscard]] bool within(double measure) const {
    return measure <= limit && measure < kInfinity;
  }
};

/// Measures the distance of a box from a fixed box.
struct GridNear {
  const double* min;
  const double* max;
  double limit;

  [[nodiscard]] double measure(const GridBox& box) const {
    return box_gap(min, max, box.low, box.high);
  }
  [[nodiscard]] bool within(double measure) const { return measure <= limit; }
};

struct FoundTriangle {
  double measure;
  std::uint32_t number;
};

struct WaitingTile {
  double measure;
  std::uint32_t column;
  std::uint32_t row;
  std::uint32_t level;
};

/// Depth-first traversal that opens the nearest tile first.
template <typename Measure>
class OrderedTraversal {
 public:
  OrderedTraversal(const HeightGrid& grid, const Measure& measure, const SlotVisitor& visitor)
      : grid_(grid), measure_(measure), visitor_(visitor) {}

  void run() {
    wait(grid_.pyramid->levels - 1, 0, 0);
    while (size_ != 0 && measure_.limit >= 0.0) {
      const WaitingTile next = waiting_[--size_];
      if (!measure_.within(next.measure)) continue;
      if (next.level == 0) {
        open_squares(next);
      } else {
        open_tiles(next);
      }
    }
  }

 private:
  void wait(std::uint32_t level, std::uint32_t column, std::uint32_t row) {
    const HeightPyramid::Level& tiles = grid_.pyramid->level[level];
    const std::size_t at = tiles.first + std::size_t{row} * tiles.columns + column;
    if (grid_.low[at] > grid_.high[at]) return;
    const auto end = [&](std::uint32_t tile, std::uint32_t squares) {
      const std::uint64_t last = (std::uint64_t{tile} + 1) * HeightPyramid::span(level);
      return static_cast<std::uint32_t>(std::min<std::uint64_t>(squares, last));
    };
    GridBox box =
        floor_box(grid_, column * HeightPyramid::span(level), row * HeightPyramid::span(level),
                  end(column, grid_.square_columns()), end(row, grid_.square_rows()));
    box.low[2] = static_cast<double>(grid_.low[at]);
    box.high[2] = static_cast<double>(grid_.high[at]);
    const double measure = measure_.measure(box);
    if (measure_.within(measure)) waiting_[size_++] = {measure, column, row, level};
  }

  void open_tiles(const WaitingTile& tile) {
    const HeightPyramid::Level& below = grid_.pyramid->level[tile.level - 1];
    const std::uint32_t before = size_;
    const std::uint32_t last_row = std::min(below.rows, (tile.row + 1) * kTileTiles);
    const std::uint32_t last_column = std::min(below.columns, (tile.column + 1) * kTileTiles);
    for (std::uint32_t row = tile.row * kTileTiles; row < last_row; ++row) {
      for (std::uint32_t column = tile.column * kTileTiles; column < last_column; ++column) {
        wait(tile.level - 1, column, row);
      }
    }
    std::sort(waiting_ + before, waiting_ + size_, [](const WaitingTile& a, const WaitingTile& b) {
      if (a.measure != b.measure) return a.measure > b.measure;
      return a.row != b.row ? a.row > b.row : a.column > b.column;
    });
  }

  void open_squares(const WaitingTile& tile) {
    found_ = 0;
    const std::uint32_t columns = grid_.square_columns();
    const std::uint32_t last_row = std::min(grid_.square_rows(), (tile.row + 1) * kTileSquares);
    const std::uint32_t first_column = tile.column * kTileSquares;
    const std::uint32_t last_column = std::min(columns, first_column + kTileSquares);
    const std::size_t at = std::size_t{tile.row} * grid_.pyramid->level[0].columns + tile.column;
    for (std::uint32_t row = tile.row * kTileSquares; row < last_row; ++row) {
      GridBox strip = floor_box(grid_, first_column, row, last_column, row + 1);
      strip.low[2] = static_cast<double>(grid_.low[at]);
      strip.high[2] = static_cast<double>(grid_.high[at]);
      if (!measure_.within(measure_.measure(strip))) continue;
      for (std::uint32_t column = first_column; column < last_column; ++column) {
        find(column, row);
      }
    }
    show();
  }

  void find(std::uint32_t column, std::uint32_t row) {
    SquareHeights heights;
    if (!heights.read(grid_, column, row)) return;
    GridBox box = floor_box(grid_, column, row, column + 1, row + 1);
    for (std::uint32_t k = 0; k < 2; ++k) {
      box.low[2] = static_cast<double>(heights.low[k]);
      box.high[2] = static_cast<double>(heights.high[k]);
      const double measure = measure_.measure(box);
      if (!measure_.within(measure)) continue;
      hits_[found_++] = {measure, 2 * (row * grid_.square_columns() + column) + k};
    }
  }

  /// Passes the hits to the visitor in order, at most sixteen at a time, while they are within the
  /// limit.
  void show() {
    std::sort(hits_, hits_ + found_, [](const FoundTriangle& a, const FoundTriangle& b) {
      return a.measure != b.measure ? a.measure < b.measure : a.number < b.number;
    });
    std::uint32_t numbers[kMeshFanout];
    for (std::uint32_t i = 0; i < found_ && measure_.limit >= 0.0;) {
      std::uint32_t count = 0;
      for (; i < found_ && count < kMeshFanout && measure_.within(hits_[i].measure); ++i) {
        numbers[count++] = hits_[i].number;
      }
      if (count == 0) return;
      measure_.limit = visitor_.visit(visitor_.context, numbers, count, measure_.limit);
    }
  }

  const HeightGrid& grid_;
  Measure measure_;
  const SlotVisitor& visitor_;
  std::uint32_t size_ = 0;
  std::uint32_t found_ = 0;
  /// Each level leaves at most 15 tiles on the stack while one is opened.
  WaitingTile waiting_[HeightPyramid::kMaxLevels * kTileTiles * kTileTiles];
  FoundTriangle hits_[2 * kTileSquares * kTileSquares];
};

}  // namespace

void height_overlap(const HeightGrid& grid, const double min[3], const double max[3],
                    SlotSink& out) noexcept {
  if (grid.columns == 0) return;
  const SquareRange columns(min[0], max[0], grid.spacing[0], grid.square_columns());
  const SquareRange rows(min[1], max[1], grid.spacing[1], grid.square_rows());
  const auto overlaps = [&](float low, float high) {
    return static_cast<double>(low) <= max[2] && static_cast<double>(high) >= min[2];
  };
  for (std::uint32_t row = rows.first; row < rows.end; ++row) {
    const std::size_t tiles = std::size_t{row / kTileSquares} * grid.pyramid->level[0].columns;
    for (std::uint32_t column = columns.first; column < columns.end;) {
      const std::uint32_t tile = column / kTileSquares;
      const std::uint32_t tile_end = std::min(columns.end, (tile + 1) * kTileSquares);
      if (!overlaps(grid.low[tiles + tile], grid.high[tiles + tile])) {
        column = tile_end;
        continue;
      }
      for (; column < tile_end; ++column) {
        SquareHeights heights;
        if (!heights.read(grid, column, row)) continue;
        const std::uint32_t number = 2 * (row * grid.square_columns() + column);
        for (std::uint32_t k = 0; k < 2; ++k) {
          if (overlaps(heights.low[k], heights.high[k])) put_slot(out, number + k);
        }
      }
    }
  }
}

void height_cast(const HeightGrid& grid, const double min[3], const double max[3],
                 const double direction[3], double limit, const SlotVisitor& visitor) noexcept {
  if (grid.columns == 0 || !(limit >= 0.0)) return;
  OrderedTraversal<GridCast>(grid, GridCast{min, max, direction, limit}, visitor).run();
}

void height_near(const HeightGrid& grid, const double min[3], const double max[3], double limit,
                 const SlotVisitor& visitor) noexcept {
  if (grid.columns == 0 || !(limit >= 0.0)) return;
  OrderedTraversal<GridNear>(grid, GridNear{min, max, limit}, visitor).run();
}

}  // namespace winnow
