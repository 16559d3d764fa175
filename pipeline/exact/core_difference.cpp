// Exact vertices and support points of the cores of convex shapes, and of the Minkowski difference
// of two of them. Used by exact_gjk.cpp and exact_overlap.cpp.

#include "pipeline/exact/core_difference.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

void set_point(CoreVertices& core, std::uint32_t i, double x, double y, double z) noexcept {
  core.own[0][i] = x;
  core.own[1][i] = y;
  core.own[2][i] = z;
}

/// Adds a polygon of 16 corners inscribed in a disc: four corners are on the circle, the others
/// slightly inside, so that rounding does not move them outside. A disc without radius is a point;
/// a tiny one gets only the four corners.
void add_disc(CoreVertices& core, const CoreDisc& disc) noexcept {
  // Cosines of multiples of 22.5 degrees, minus a few units in the last place.
  constexpr double kShare[5] = {1.0, 0.92387953251128596, 0.70710678118654702, 0.38268343236508945,
                                0.0};
  constexpr double kSmallest = 0x1p-900;  // below it, the error of a product is not relative
  if (disc.radius == 0.0) return set_point(core, core.count++, 0.0, 0.0, disc.z);
  const int step = disc.radius < kSmallest ? 4 : 1;
  for (int k = 0; k < 4; k += step) {
    const double near = disc.radius * kShare[k];
    const double side = disc.radius * kShare[4 - k];
    set_point(core, core.count++, near, side, disc.z);
    set_point(core, core.count++, -side, near, disc.z);
    set_point(core, core.count++, -near, -side, disc.z);
    set_point(core, core.count++, side, -near, disc.z);
  }
}

/// The convex hull of discs at both ends of the z axis, the upper one not larger.
void set_discs(CoreVertices& core, double half_length, double low_radius,
               double high_radius) noexcept {
  core.count = 0;
  core.has_discs = true;
  core.disc[0] = {-half_length, low_radius};
  core.disc[1] = {half_length, high_radius};
  for (const CoreDisc& disc : core.disc) add_disc(core, disc);
}

void set_corners(CoreVertices& core, const CornerTable& corners,
                 const Eigen::Vector3d& half) noexcept {
  core.count = corners.corners;
  for (std::uint32_t i = 0; i < core.count; ++i) {
    const std::int8_t* const at = corners.corner[i];
    set_point(core, i, at[0] * half.x(), at[1] * half.y(), at[2] * half.z());
  }
}

void set_triangle(CoreVertices& core, const TriangleShape& triangle) noexcept {
  core.count = 3;
  for (std::uint32_t i = 0; i < 3; ++i) {
    set_point(core, i, triangle.vertex[i][0], triangle.vertex[i][1], triangle.vertex[i][2]);
  }
}

struct Bounds {
  double lower;
  double upper;
};

/// Bounds on the dot product of a vertex with a direction whose components have a relative error of
/// 2^-51 (or the absolute error of underflow).
[[nodiscard]] Bounds product_bounds(const CoreVertices& core, std::uint32_t i,
                                    const RoundedDirection& direction) noexcept {
  constexpr double kError = 0x1p-49;
  // Exceeds the error of underflow, but is not subnormal, because adding subnormals is slow.
  constexpr double kUnderflow = 0x1p-1000;
  double value = 0.0;
  double size = 0.0;
  double length = 1.0;
  for (int k = 0; k < 3; ++k) {
    const double term = direction.d[k] * core.column[k][i];
    value += term;
    size += std::fabs(term);
    length += std::fabs(core.column[k][i]);
  }
  const double error = kError * size + kUnderflow * length;
  if (!std::isfinite(length) || !std::isfinite(size)) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    return {-kInfinity, kInfinity};
  }
  return {value - error, value + error};
}

/// Upper bound on the height of the core's points along `direction`.
[[nodiscard]] Dyadic core_height_bound(const CoreVertices& core,
                                       const ExactVector& direction) noexcept {
  Dyadic height;
  if (!core.has_discs) {
    farthest_vertex(core, direction, height);
    return height;
  }
  const Dyadic across =
      root_above(direction.x[0] * direction.x[0] + direction.x[1] * direction.x[1]);
  const auto reach = [&](const CoreDisc& disc) {
    return direction.x[2] * disc.z + across * disc.radius;
  };
  height = reach(core.disc[0]);
  const Dyadic other = reach(core.disc[1]);
  return compare(other, height) > 0 ? other : height;
}

}  // namespace

bool core_vertices(const ShapeCore& shape, CoreVertices& core) noexcept {
  core.rounding = shape.rounding;
  if (shape.hull != nullptr) {
    core.count = shape.hull->vertex_count;
    for (int k = 0; k < 3; ++k) core.column[k] = shape.hull->vertex[k];
  } else if (shape.triangle != nullptr) {
    set_triangle(core, *shape.triangle);
  } else if (shape.corners != nullptr) {
    set_corners(core, *shape.corners, shape.half);
  } else if (shape.has_discs()) {
    set_discs(core, shape.half.z(), shape.half.x(), shape.top());
  } else {
    return false;
  }
  return true;
}

void CoreVertices::include_lengths(BitSpan& span) const noexcept {
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const double* values : column) span.include(values[i]);
  }
  span.include(rounding);
}

std::uint32_t farthest_vertex(const CoreVertices& core, const ExactVector& direction,
                              Dyadic& height) noexcept {
  const RoundedDirection rounded(direction);
  double reached = -std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < core.count; ++i) {
    reached = std::max(reached, product_bounds(core, i, rounded).lower);
  }
  std::uint32_t best = core.count;
  for (std::uint32_t i = 0; i < core.count; ++i) {
    if (product_bounds(core, i, rounded).upper < reached) continue;
    const Dyadic product = dot(direction, core.at(i));
    if (best != core.count && compare(product, height) <= 0) continue;
    best = i;
    height = product;
  }
  return best;
}

CoreDifference::CoreDifference(const CoreVertices& core_a, const Pose& pose_a,
                               const CoreVertices& core_b, const Pose& pose_b) noexcept
    : a_(core_a), b_(core_b) {
  const Dyadic square_a = square_length(pose_a.orientation);
  const Dyadic square_b = square_length(pose_b.orientation);
  scale_ = square_a * square_b;
  turn_a_ = scaled_rotation(pose_a.orientation);
  turn_b_ = scaled_rotation(pose_b.orientation);
  for (ExactVector& row : turn_a_.row) row = row * square_b;
  for (ExactVector& row : turn_b_.row) row = row * square_a;
  const ExactVector between = exact_vector(pose_b.position) - exact_vector(pose_a.position);
  offset_ = between * scale_;

  BitSpan lengths;
  core_a.include_lengths(lengths);
  core_b.include_lengths(lengths);
  for (const Dyadic& x : between.x) lengths.include(x);
  constexpr int kSums = 6;
  const int turns = rotation_bits(pose_a) + rotation_bits(pose_b);
  in_range_ = fits_dyadic(6, turns + lengths.bits() + kSums);
  heights_in_range_ = fits_dyadic(1, 4 * turns + lengths.bits() + kSums);
}

void CoreDifference::support(const ExactVector& direction, ExactVector& vertex,
                             Dyadic& height) const noexcept {
  Dyadic height_a;
  Dyadic height_b;
  const std::uint32_t a = farthest_vertex(a_, transposed_times(turn_a_, direction), height_a);
  const std::uint32_t b = farthest_vertex(b_, transposed_times(turn_b_, -direction), height_b);
  height = height_a + height_b - dot(direction, offset_);
  vertex = turn_a_ * a_.at(a) - turn_b_ * b_.at(b) - offset_;
}

Dyadic CoreDifference::height_bound(const ExactVector& direction) const noexcept {
  return core_height_bound(a_, transposed_times(turn_a_, direction)) +
         core_height_bound(b_, transposed_times(turn_b_, -direction)) - dot(direction, offset_);
}

}  // namespace winnow
