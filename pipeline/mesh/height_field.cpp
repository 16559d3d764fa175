#include <winnow/pipeline/height_field.h>

#include <winnow/pipeline/triangle_mesh.h>
#include "pipeline/mesh/edge_bend.h"
#include "pipeline/mesh/height_walks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

constexpr double kMaxTriangles = 268435456.0;

std::size_t stride_of(const HeightSamples& samples) {
  return samples.row_stride != 0 ? samples.row_stride : samples.columns;
}

/// Of at least one column and row.
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

/// Samples of a square's even and odd triangle, as steps from its own sample: the corners, and for
/// the edge from each to the next the far corner of the triangle beyond.
struct Steps {
  int column;
  int row;
};
constexpr Steps kCorner[2][3] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
constexpr Steps kBeyond[2][3] = {{{0, -1}, {2, 1}, {0, 1}}, {{1, 0}, {1, 2}, {-1, 0}}};
/// The square that the triangle beyond is of.
constexpr Steps kSquareBeyond[2][3] = {{{0, -1}, {1, 0}, {0, 0}}, {{0, 0}, {0, 1}, {-1, 0}}};

/// Below zero it wraps to a number that no column has.
std::uint32_t moved(std::uint32_t from, int by) {
  return from + static_cast<std::uint32_t>(by);
}

struct Sample {
  double at[3];

  Sample(const HeightGrid& grid, std::uint32_t column, std::uint32_t row)
      : at{column * grid.spacing[0], row * grid.spacing[1],
           static_cast<double>(grid.heights[std::size_t{row} * grid.columns + column])} {}
};

}  // namespace

HeightField::HeightField(std::pmr::memory_resource* memory) noexcept
    : heights_(memory), tiles_(memory) {}

HeightField::HeightField(HeightField&& other) noexcept : HeightField(other.heights_.memory()) {
  heights_.swap(other.heights_);
  tiles_.swap(other.tiles_);
  std::swap(pyramid_, other.pyramid_);
  std::swap(columns_, other.columns_);
  std::swap(rows_, other.rows_);
  std::swap(spacing_, other.spacing_);
}

HeightGrid HeightField::grid() const noexcept {
  return {heights_.data(),
          columns_,
          rows_,
          {spacing_[0], spacing_[1]},
          &pyramid_,
          tiles_.data(),
          tiles_.data() + pyramid_.tiles};
}

Status HeightField::build(const HeightSamples& samples) {
  const Status status = check_field(samples);
  if (status != Status::ok) return status;
  const HeightPyramid pyramid = HeightPyramid::plan(samples.columns - 1, samples.rows - 1);
  Column<float> heights(heights_.memory());
  Column<float> tiles(heights_.memory());
  if (!heights.resize(std::size_t{samples.columns} * samples.rows) ||
      !tiles.resize(2 * pyramid.tiles)) {
    return Status::out_of_memory;
  }
  heights_.swap(heights);
  tiles_.swap(tiles);
  pyramid_ = pyramid;
  columns_ = samples.columns;
  rows_ = samples.rows;
  std::copy_n(samples.spacing, 2, spacing_);
  put(0, 0, samples);
  return Status::ok;
}

Status HeightField::update(std::uint32_t column, std::uint32_t row, const HeightSamples& samples) {
  if (column > columns_ || row > rows_ || samples.columns > columns_ - column ||
      samples.rows > rows_ - row) {
    return Status::invalid_argument;
  }
  if (samples.columns == 0 || samples.rows == 0) return Status::ok;
  const Status status = check(samples);
  if (status == Status::ok) put(column, row, samples);
  return status;
}

void HeightField::put(std::uint32_t column, std::uint32_t row,
                      const HeightSamples& samples) noexcept {
  const std::size_t stride = stride_of(samples);
  for (std::size_t r = 0; r < samples.rows; ++r) {
    std::copy_n(samples.heights.data() + r * stride, samples.columns,
                heights_.data() + (row + r) * columns_ + column);
  }
  // A sample is a corner of the squares before it too.
  const TileRange squares{
      {column - std::min(column, 1U), row - std::min(row, 1U)},
      {std::min(columns_ - 1, column + samples.columns), std::min(rows_ - 1, row + samples.rows)}};
  fit_tiles(grid(), squares, tiles_.data(), tiles_.data() + pyramid_.tiles);
}

std::uint32_t HeightField::triangles() const noexcept {
  return columns_ < 2 ? 0 : 2 * (columns_ - 1) * (rows_ - 1);
}

bool HeightField::triangle(std::uint32_t number, TriangleShape& shape) const noexcept {
  if (number >= triangles()) return false;
  const HeightGrid grid = this->grid();
  const std::uint32_t column = number / 2 % grid.square_columns();
  const std::uint32_t row = number / 2 / grid.square_columns();
  for (int k = 0; k < 3; ++k) {
    const Steps& step = kCorner[number % 2][k];
    const Sample corner(grid, moved(column, step.column), moved(row, step.row));
    std::copy_n(corner.at, 3, shape.vertex[k]);
  }
  shape.rounding = 0.0;
  return grid.has_square(column, row);
}

std::uint8_t HeightField::active_edges(std::uint32_t number) const noexcept {
  static const EdgeBend kBend(MeshOptions{}.active_edge_angle);
  TriangleShape shape;
  std::uint8_t active = 7;
  if (!triangle(number, shape)) return active;
  const HeightGrid grid = this->grid();
  const std::uint32_t column = number / 2 % grid.square_columns();
  const std::uint32_t row = number / 2 / grid.square_columns();
  for (unsigned k = 0; k < 3; ++k) {
    const Steps& square = kSquareBeyond[number % 2][k];
    if (!grid.has_square(moved(column, square.column), moved(row, square.row))) continue;
    const Steps& far = kBeyond[number % 2][k];
    const Sample beyond(grid, moved(column, far.column), moved(row, far.row));
    if (!kBend.is_active(shape.vertex[k], shape.vertex[(k + 1) % 3], shape.vertex[(k + 2) % 3],
                         beyond.at, true)) {
      active = static_cast<std::uint8_t>(active & ~(1U << k));
    }
  }
  return active;
}

Aabb HeightField::bounds() const noexcept {
  if (triangles() == 0) return {};
  const float low = tiles_[pyramid_.tiles - 1];
  const float high = tiles_[2 * pyramid_.tiles - 1];
  if (low > high) return {};
  Aabb box;
  box.min = {0.0F, 0.0F, low};
  box.max = {round_up((columns_ - 1) * spacing_[0]), round_up((rows_ - 1) * spacing_[1]), high};
  return box;
}

double HeightField::radius() const noexcept {
  const Aabb box = bounds();
  if (!box.is_valid()) return 0.0;
  const Eigen::Vector3f farthest = box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs());
  return farthest.cast<double>().norm() * (1.0 + 4.0 * std::numeric_limits<double>::epsilon());
}

void HeightField::overlap(const double min[3], const double max[3], SlotSink& out) const noexcept {
  if (triangles() != 0) height_overlap(grid(), min, max, out);
}

void HeightField::sweep(const double min[3], const double max[3], const double direction[3],
                        double limit, const SlotVisitor& visitor) const noexcept {
  if (triangles() != 0) height_sweep(grid(), min, max, direction, limit, visitor);
}

void HeightField::near(const double min[3], const double max[3], double limit,
                       const SlotVisitor& visitor) const noexcept {
  if (triangles() != 0) height_near(grid(), min, max, limit, visitor);
}

Footprint HeightField::footprint() const noexcept {
  Footprint result;
  result.bounds = heights_.bytes();
  result.structure = tiles_.bytes();
  return result;
}

}  // namespace winnow
