#include <winnow/pipeline/height_field.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Status check(const HeightSamples& samples) {
  const std::size_t stride = samples.row_stride != 0 ? samples.row_stride : samples.columns;
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

}  // namespace

HeightField::HeightField(std::pmr::memory_resource* memory) noexcept : heights_(memory) {}

Status HeightField::build(const HeightSamples& samples) {
  if (samples.columns < 2 || samples.rows < 2) return Status::invalid_shape;
  for (const double spacing : samples.spacing) {
    if (!(spacing > 0.0 && std::isfinite(spacing))) return Status::invalid_shape;
  }
  if (2.0 * (samples.columns - 1.0) * (samples.rows - 1.0) > 268435456.0) {
    return Status::too_many_objects;
  }
  const Status status = check(samples);
  if (status != Status::ok) return status;
  Column<float> fresh(heights_.memory());
  if (!fresh.resize(std::size_t{samples.columns} * samples.rows)) return Status::out_of_memory;
  heights_.swap(fresh);
  columns_ = samples.columns;
  rows_ = samples.rows;
  std::copy_n(samples.spacing, 2, spacing_);
  return update(0, 0, samples);
}

Status HeightField::update(std::uint32_t column, std::uint32_t row, const HeightSamples& samples) {
  if (column > columns_ || row > rows_ || samples.columns > columns_ - column ||
      samples.rows > rows_ - row) {
    return Status::invalid_argument;
  }
  if (samples.columns == 0 || samples.rows == 0) return Status::ok;
  const Status status = check(samples);
  if (status != Status::ok) return status;
  const std::size_t stride = samples.row_stride != 0 ? samples.row_stride : samples.columns;
  for (std::size_t r = 0; r < samples.rows; ++r) {
    std::copy_n(samples.heights.data() + r * stride, samples.columns,
                heights_.data() + (row + r) * columns_ + column);
  }
  return Status::ok;
}

std::uint32_t HeightField::triangles() const noexcept {
  return columns_ < 2 ? 0 : 2 * (columns_ - 1) * (rows_ - 1);
}

bool HeightField::triangle(std::uint32_t number, TriangleShape& shape) const noexcept {
  const std::uint32_t square = number / 2;
  const std::uint32_t column = square % (columns_ - 1);
  const std::uint32_t row = square / (columns_ - 1);
  const std::uint32_t c[3] = {column, column + 1, column + (number % 2 == 0 ? 1 : 0)};
  const std::uint32_t r[3] = {row, row + (number % 2 == 0 ? 0 : 1), row + 1};
  for (int k = 0; k < 3; ++k) {
    const std::size_t at = std::size_t{r[k]} * columns_ + c[k];
    shape.vertex[k][0] = c[k] * spacing_[0];
    shape.vertex[k][1] = r[k] * spacing_[1];
    shape.vertex[k][2] = static_cast<double>(heights_[at]);
  }
  shape.rounding = 0.0;
  const std::size_t corner = std::size_t{row} * columns_ + column;
  return !(std::isnan(heights_[corner]) || std::isnan(heights_[corner + 1]) ||
           std::isnan(heights_[corner + columns_]) || std::isnan(heights_[corner + columns_ + 1]));
}

std::uint8_t HeightField::active_edges(std::uint32_t) const noexcept {
  return 7;
}

Aabb HeightField::bounds() const noexcept {
  Aabb box;
  for (std::uint32_t i = 0; i < triangles(); ++i) {
    TriangleShape shape;
    if (!triangle(i, shape)) continue;
    for (const auto& v : shape.vertex) {
      const Eigen::Vector3d point(v[0], v[1], v[2]);
      box.merge(Aabb::outward(point, point));
    }
  }
  return box;
}

double HeightField::radius() const noexcept {
  const Aabb box = bounds();
  if (!box.is_valid()) return 0.0;
  return box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs()).cast<double>().norm() * (1.0 + 1e-15);
}

void HeightField::overlap(const double min[3], const double max[3], SlotSink& out) const noexcept {
  for (std::uint32_t i = 0; i < triangles(); ++i) {
    TriangleShape shape;
    bool met = triangle(i, shape);
    for (int axis = 0; axis < 3 && met; ++axis) {
      const auto& v = shape.vertex;
      met = std::min({v[0][axis], v[1][axis], v[2][axis]}) <= max[axis] &&
            min[axis] <= std::max({v[0][axis], v[1][axis], v[2][axis]});
    }
    if (!met) continue;
    if (out.size < out.capacity) out.slot[out.size] = i;
    ++out.size;
  }
}

void HeightField::sweep(const double min[3], const double max[3], const double direction[3],
                        double limit, const SlotVisitor& visitor) const noexcept {
  for (std::uint32_t i = 0; i < triangles() && limit >= 0.0; ++i) {
    TriangleShape shape;
    if (!triangle(i, shape)) continue;
    double first = 0.0;
    double last = limit;
    for (int axis = 0; axis < 3; ++axis) {
      const auto& v = shape.vertex;
      const double near = std::min({v[0][axis], v[1][axis], v[2][axis]}) - max[axis];
      const double far = std::max({v[0][axis], v[1][axis], v[2][axis]}) - min[axis];
      if (direction[axis] == 0.0) {
        if (near > 0.0 || far < 0.0) first = kInfinity;
        continue;
      }
      const double a = near / direction[axis];
      const double b = far / direction[axis];
      first = std::max(first, std::min(a, b) * (1.0 - 1e-15));
      last = std::min(last, std::max(a, b) * (1.0 + 1e-15));
    }
    if (first <= last) limit = visitor.visit(visitor.context, &i, 1, limit);
  }
}

void HeightField::near(const double min[3], const double max[3], double limit,
                       const SlotVisitor& visitor) const noexcept {
  for (std::uint32_t i = 0; i < triangles() && limit >= 0.0; ++i) {
    TriangleShape shape;
    if (!triangle(i, shape)) continue;
    double square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto& v = shape.vertex;
      const double gap = std::max({0.0, std::min({v[0][axis], v[1][axis], v[2][axis]}) - max[axis],
                                   min[axis] - std::max({v[0][axis], v[1][axis], v[2][axis]})});
      square += gap * gap;
    }
    if (std::sqrt(square) * (1.0 - 1e-15) <= limit) {
      limit = visitor.visit(visitor.context, &i, 1, limit);
    }
  }
}

Footprint HeightField::footprint() const noexcept {
  Footprint result;
  result.bounds = heights_.bytes();
  return result;
}

}  // namespace winnow
