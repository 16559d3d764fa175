#include <winnow/core/eigen.h>

#include "core/threads/float_environment.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/shape_pool_put.h"

#include <Eigen/Core>
#include <cmath>
#include <limits>

namespace winnow {

#define WINNOW_PAIRS(WINNOW_X) \
  WINNOW_X(sphere, half_space) \
  WINNOW_X(box, half_space)
WINNOW_DEFINE_LINK(half_space, WINNOW_PAIRS)
#undef WINNOW_PAIRS

Answer<ShapeId> ShapePool::add(const HalfSpaceShape& shape) {
  const DefaultFloatEnvironment environment;
  const auto normal = as_eigen(shape.normal);
  if (!std::isfinite(shape.offset) || !normal.allFinite()) return Status::invalid_shape;
  // Scale by the largest component first: the squares of a small normal would underflow.
  const double largest = normal.cwiseAbs().maxCoeff();
  if (largest == 0.0) return Status::invalid_shape;
  link_kernels_of_half_space();
  // A normal that a pool has already normalised is stored bit for bit, so that copies between pools
  // are exact.
  constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();
  if (std::abs(normal.squaredNorm() - 1.0) <= kRounding) {
    return PoolRows::put(*this, shape);
  }
  const Eigen::Vector3d scaled = normal / largest;
  const Eigen::Vector3d unit = scaled.normalized();
  const double offset = shape.offset / largest / scaled.norm();
  if (!std::isfinite(offset)) return Status::invalid_shape;
  return PoolRows::put(*this, HalfSpaceShape{{unit.x(), unit.y(), unit.z()}, offset});
}

}  // namespace winnow
