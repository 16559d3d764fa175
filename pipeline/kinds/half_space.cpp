#include "pipeline/kernels/link.h"
#include "pipeline/shapes/put_shape.h"

#include <Eigen/Core>
#include <cmath>

namespace winnow {

#define WINNOW_PAIRS(WINNOW_X) \
  WINNOW_X(sphere, half_space) \
  WINNOW_X(box, half_space)
WINNOW_DEFINE_LINK(half_space, WINNOW_PAIRS)
#undef WINNOW_PAIRS

Status ShapePool::add(const HalfSpaceShape& shape, ShapeId& id) {
  const Eigen::Map<const Eigen::Vector3d> normal(shape.normal);
  if (!std::isfinite(shape.offset) || !normal.allFinite()) return Status::invalid_shape;
  // Scaled by its largest component first: squares of small normals would vanish.
  const double largest = normal.cwiseAbs().maxCoeff();
  if (largest == 0.0) return Status::invalid_shape;
  const Eigen::Vector3d scaled = normal / largest;
  const Eigen::Vector3d unit = scaled.normalized();
  const double offset = shape.offset / largest / scaled.norm();
  if (!std::isfinite(offset)) return Status::invalid_shape;
  link_kernels_of_half_space();
  return put(half_spaces_, ShapeKind::half_space,
             HalfSpaceShape{{unit.x(), unit.y(), unit.z()}, offset}, id);
}

}  // namespace winnow
