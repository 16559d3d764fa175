// HeightField: validation, storage, active edges, snapshots, and the pyramid of minimum and maximum
// heights over tiles. height_traversal.cpp searches the pyramid.

#include <winnow/pipeline/surfaces.h>

#include <winnow/core/eigen.h>
#include <winnow/core/memory.h>
#include <winnow/core/volumes.h>
#include "core/memory/new_in.h"
#include "core/memory/snapshot_frame.h"
#include "core/threads/float_environment.h"
#include "pipeline/mesh/edge_bend.h"
#include "pipeline/mesh/height_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace winnow {
namespace {

constexpr std::string_view kFieldMagic = "WINNOWHF";
constexpr std::uint32_t kFieldVersion = 1;

std::size_t stride_of(const HeightSamples& samples) {
  return samples.row_stride != 0 ? samples.row_stride : samples.columns;
}

/// Requires at least one column and row.
Status check(const HeightSamples& samples) {
  const std::size_t stride = stride_of(samples);
  if (stride < samples.columns) return Status::invalid_argument;
  const std::size_t needed = (samples.rows - std::size_t{1}) * stride + samples.columns;
  if (samples.heights.size() < needed) return Status::size_mismatch;
  for (std::size_t row = 0; row < samples.rows; ++row) {
    for (const float height : samples.heights.subspan(row * stride, samples.columns)) {
      if (std::isinf(height)) return Status::invalid_shape;
    }
  }
  return Status::ok;
}

Status check_field(const HeightSamples& samples) {
  if (samples.columns < 2 || samples.rows < 2) return Status::invalid_shape;
  const double squares[2] = {samples.columns - 1.0, samples.rows - 1.0};
  for (int axis = 0; axis < 2; ++axis) {
    const double length = samples.spacing[axis] * squares[axis];
    if (!(samples.spacing[axis] > 0.0 &&
          length <= static_cast<double>(std::numeric_limits<float>::max()))) {
      return Status::invalid_shape;
    }
  }
  if (2.0 * squares[0] * squares[1] > kMaxTriangles) return Status::too_many_objects;
  return check(samples);
}

/// Offset from a square's own sample. The first index of the tables below selects the even or the
/// odd triangle of the square. kCorner contains its corners; kBeyond contains, for the edge from
/// each corner to the next, the opposite corner of the triangle across the edge.
struct SampleStep {
  int column;
  int row;
};
constexpr SampleStep kCorner[2][3] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
constexpr SampleStep kBeyond[2][3] = {{{0, -1}, {2, 1}, {0, 1}}, {{1, 0}, {1, 2}, {-1, 0}}};
/// Offset of the square that contains the triangle across the edge.
constexpr SampleStep kSquareBeyond[2][3] = {{{0, -1}, {1, 0}, {0, 0}}, {{0, 0}, {0, 1}, {-1, 0}}};

/// A negative result wraps to a number that is not a valid column.
std::uint32_t moved(std::uint32_t from, int by) {
  return from + static_cast<std::uint32_t>(by);
}

struct HeightRange {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();

  void add(float least, float greatest) {
    low = std::min(low, least);
    high = std::max(high, greatest);
  }
};

bool has_all(const float (&height)[4]) {
  return !(std::isnan(height[0]) || std::isnan(height[1]) || std::isnan(height[2]) ||
           std::isnan(height[3]));
}

HeightRange over_squares(const HeightGrid& grid, std::uint32_t tile_column,
                         std::uint32_t tile_row) {
  HeightRange result;
  const std::uint32_t last_row = std::min(grid.square_rows(), (tile_row + 1) * kTileSquares);
  const std::uint32_t last_column =
      std::min(grid.square_columns(), (tile_column + 1) * kTileSquares);
  for (std::uint32_t row = tile_row * kTileSquares; row < last_row; ++row) {
    for (std::uint32_t column = tile_column * kTileSquares; column < last_column; ++column) {
      float height[4];
      grid.corners(column, row, height);
      if (!has_all(height)) continue;
      result.add(std::min({height[0], height[1], height[2], height[3]}),
                 std::max({height[0], height[1], height[2], height[3]}));
    }
  }
  return result;
}

HeightRange over_tiles(const HeightPyramid& pyramid, std::uint32_t level, std::uint32_t tile_column,
                       std::uint32_t tile_row, const float* low, const float* high) {
  const HeightPyramid::Level& below = pyramid.level[level - 1];
  HeightRange result;
  const std::uint32_t last_row = std::min(below.rows, (tile_row + 1) * kTileTiles);
  const std::uint32_t last_column = std::min(below.columns, (tile_column + 1) * kTileTiles);
  for (std::uint32_t row = tile_row * kTileTiles; row < last_row; ++row) {
    for (std::uint32_t column = tile_column * kTileTiles; column < last_column; ++column) {
      const std::size_t at = below.first + std::size_t{row} * below.columns + column;
      result.add(low[at], high[at]);
    }
  }
  return result;
}

struct GridPoint {
  double at[3];

  GridPoint(const HeightGrid& grid, std::uint32_t column, std::uint32_t row)
      : at{column * grid.spacing[0], row * grid.spacing[1],
           static_cast<double>(grid.heights[std::size_t{row} * grid.columns + column])} {}
};

}  // namespace

HeightPyramid HeightPyramid::plan(std::uint32_t columns, std::uint32_t rows) noexcept {
  HeightPyramid result;
  std::uint32_t side = kTileSquares;
  do {
    columns = (columns + side - 1) / side;
    rows = (rows + side - 1) / side;
    result.level[result.levels++] = {columns, rows, result.tiles};
    result.tiles += std::size_t{columns} * rows;
    side = kTileTiles;
  } while (columns > 1 || rows > 1);
  return result;
}

bool HeightGrid::has_square(std::uint32_t column, std::uint32_t row) const noexcept {
  if (column >= square_columns() || row >= square_rows()) return false;
  float height[4];
  corners(column, row, height);
  return has_all(height);
}

void fit_tiles(const HeightGrid& grid, const TileRange& squares, float* low, float* high) noexcept {
  const HeightPyramid& pyramid = *grid.pyramid;
  for (std::uint32_t level = 0; level < pyramid.levels; ++level) {
    const HeightPyramid::Level& tiles = pyramid.level[level];
    const std::uint32_t span = HeightPyramid::span(level);
    for (std::uint32_t row = squares.low[1] / span; row <= (squares.high[1] - 1) / span; ++row) {
      for (std::uint32_t column = squares.low[0] / span; column <= (squares.high[0] - 1) / span;
           ++column) {
        const HeightRange heights = level == 0 ? over_squares(grid, column, row)
                                               : over_tiles(pyramid, level, column, row, low, high);
        const std::size_t at = tiles.first + std::size_t{row} * tiles.columns + column;
        low[at] = heights.low;
        high[at] = heights.high;
      }
    }
  }
}

/// The samples and the tile pyramid over them.
struct HeightField::State {
  explicit State(std::pmr::memory_resource* memory) noexcept : heights(memory), tiles(memory) {}

  [[nodiscard]] HeightGrid grid() const noexcept {
    return {heights.data(),
            columns,
            rows,
            {spacing[0], spacing[1]},
            &pyramid,
            tiles.data(),
            tiles.data() + pyramid.tiles};
  }
  [[nodiscard]] Status take(const HeightSamples& samples) noexcept;
  void put(std::uint32_t column, std::uint32_t row, const HeightSamples& samples) noexcept;

  Column<float> heights;
  /// The minimum heights of all tiles, then their maximum heights.
  Column<float> tiles;
  HeightPyramid pyramid;
  std::uint32_t columns = 0;
  std::uint32_t rows = 0;
  double spacing[2] = {1.0, 1.0};
};

HeightField::HeightField(HeightField&& other) noexcept
    : memory_(other.memory_), state_(std::exchange(other.state_, nullptr)) {}

HeightField::~HeightField() {
  delete_in(memory_, state_);
}

Status HeightField::build(const HeightSamples& samples) {
  const DefaultFloatEnvironment environment;
  const Status status = check_field(samples);
  if (status != Status::ok) return status;
  State* fresh = new_in<State>(memory_, memory_);
  if (fresh == nullptr) return Status::out_of_memory;
  const Status taken = fresh->take(samples);
  if (taken == Status::ok) std::swap(state_, fresh);
  delete_in(memory_, fresh);
  return taken;
}

Status HeightField::State::take(const HeightSamples& samples) noexcept {
  pyramid = HeightPyramid::plan(samples.columns - 1, samples.rows - 1);
  if (!heights.resize(std::size_t{samples.columns} * samples.rows) ||
      !tiles.resize(2 * pyramid.tiles)) {
    return Status::out_of_memory;
  }
  columns = samples.columns;
  rows = samples.rows;
  std::copy_n(samples.spacing, 2, spacing);
  put(0, 0, samples);
  return Status::ok;
}

Status HeightField::update(std::uint32_t column, std::uint32_t row, const HeightSamples& samples) {
  const DefaultFloatEnvironment environment;
  if (column > columns() || row > rows() || samples.columns > columns() - column ||
      samples.rows > rows() - row) {
    return Status::invalid_argument;
  }
  if (samples.columns == 0 || samples.rows == 0) return Status::ok;
  const Status status = check(samples);
  if (status == Status::ok) state_->put(column, row, samples);
  return status;
}

void HeightField::State::put(std::uint32_t column, std::uint32_t row,
                             const HeightSamples& samples) noexcept {
  const std::size_t stride = stride_of(samples);
  for (std::size_t r = 0; r < samples.rows; ++r) {
    std::copy_n(samples.heights.data() + r * stride, samples.columns,
                heights.data() + (row + r) * columns + column);
  }
  // A sample is also a corner of the squares in the previous column and row.
  const TileRange squares{
      {column - std::min(column, 1U), row - std::min(row, 1U)},
      {std::min(columns - 1, column + samples.columns), std::min(rows - 1, row + samples.rows)}};
  fit_tiles(grid(), squares, tiles.data(), tiles.data() + pyramid.tiles);
}

HeightGrid grid_of(const HeightField& field) noexcept {
  return field.state_ != nullptr ? field.state_->grid() : HeightGrid{};
}

std::uint32_t HeightField::columns() const noexcept {
  return state_ != nullptr ? state_->columns : 0;
}

std::uint32_t HeightField::rows() const noexcept {
  return state_ != nullptr ? state_->rows : 0;
}

std::uint32_t HeightField::triangles() const noexcept {
  return state_ != nullptr ? 2 * (columns() - 1) * (rows() - 1) : 0;
}

bool HeightField::triangle(std::uint32_t number, TriangleShape& shape) const noexcept {
  const DefaultFloatEnvironment environment;
  if (number >= triangles()) return false;
  const HeightGrid grid = state_->grid();
  const std::uint32_t column = number / 2 % grid.square_columns();
  const std::uint32_t row = number / 2 / grid.square_columns();
  for (int k = 0; k < 3; ++k) {
    const SampleStep& step = kCorner[number % 2][k];
    const GridPoint corner(grid, moved(column, step.column), moved(row, step.row));
    shape.vertex[k] = corner.at;
  }
  shape.rounding = 0.0;
  return grid.has_square(column, row);
}

std::uint8_t HeightField::active_edges(std::uint32_t number) const noexcept {
  const DefaultFloatEnvironment environment;
  static const EdgeBend kBend(MeshOptions{}.active_edge_angle);
  TriangleShape shape;
  std::uint8_t active = 7;
  if (!triangle(number, shape)) return active;
  const HeightGrid grid = state_->grid();
  const std::uint32_t column = number / 2 % grid.square_columns();
  const std::uint32_t row = number / 2 / grid.square_columns();
  for (unsigned k = 0; k < 3; ++k) {
    const SampleStep& square = kSquareBeyond[number % 2][k];
    if (!grid.has_square(moved(column, square.column), moved(row, square.row))) continue;
    const SampleStep& far = kBeyond[number % 2][k];
    const GridPoint beyond(grid, moved(column, far.column), moved(row, far.row));
    if (!kBend.is_active(shape.vertex[k], shape.vertex[(k + 1) % 3], shape.vertex[(k + 2) % 3],
                         beyond.at, true)) {
      active = static_cast<std::uint8_t>(active & ~(1U << k));
    }
  }
  return active;
}

Status HeightField::save(Column<std::byte>& out) const {
  return write_snapshot(out, kFieldMagic, kFieldVersion, [&](ByteWriter& writer) {
    if (state_ == nullptr) return;
    writer.put_bytes(state_->spacing, sizeof state_->spacing);
    writer.put(state_->columns);
    writer.put(state_->rows);
    writer.put_array(std::span<const float>(state_->heights.data(), state_->heights.size()));
  });
}

Status HeightField::load(std::span<const std::byte> saved) {
  const DefaultFloatEnvironment environment;
  ByteReader in = open_snapshot(saved, kFieldMagic, kFieldVersion);
  HeightField fresh(memory_);
  if (in.ok() && !in.rest().empty()) {
    HeightSamples samples;
    Column<float> heights(memory_);
    (void)in.get_bytes(samples.spacing, sizeof samples.spacing);
    samples.columns = in.get<std::uint32_t>();
    samples.rows = in.get<std::uint32_t>();
    (void)in.get_array(heights);
    if (heights.size() != std::size_t{samples.columns} * samples.rows || !in.rest().empty()) {
      in.fail();
    }
    samples.heights = {heights.data(), heights.size()};
    const Status built = in.ok() ? fresh.build(samples) : Status::ok;
    if (built == Status::out_of_memory) return built;
    if (built != Status::ok) in.fail();
  }
  if (in.ok()) std::swap(state_, fresh.state_);
  return status_of(in);
}

Aabb HeightField::bounds() const noexcept {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return {};
  const State& s = *state_;
  const float low = s.tiles[s.pyramid.tiles - 1];
  const float high = s.tiles[2 * s.pyramid.tiles - 1];
  if (low > high) return {};
  Aabb box;
  box.min = {0.0F, 0.0F, low};
  box.max = {round_up((s.columns - 1) * s.spacing[0]), round_up((s.rows - 1) * s.spacing[1]), high};
  return box;
}

double HeightField::radius() const noexcept {
  const DefaultFloatEnvironment environment;
  const Aabb box = bounds();
  if (!box.is_valid()) return 0.0;
  const Eigen::Vector3f farthest =
      as_eigen(box.min).cwiseAbs().cwiseMax(as_eigen(box.max).cwiseAbs());
  return farthest.cast<double>().norm() * (1.0 + 4.0 * std::numeric_limits<double>::epsilon());
}

Footprint HeightField::footprint() const noexcept {
  Footprint result;
  if (state_ == nullptr) return result;
  result.bounds = state_->heights.bytes();
  result.structure = {sizeof(State), sizeof(State)};
  result.structure += state_->tiles.bytes();
  return result;
}

}  // namespace winnow
