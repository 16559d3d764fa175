#include "core/threads/float_environment.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/shape_pool_put.h"

namespace winnow {

#define WINNOW_PAIRS(WINNOW_X)   \
  WINNOW_X(sphere, cylinder)     \
  WINNOW_X(box, cylinder)        \
  WINNOW_X(cylinder, half_space) \
  WINNOW_X(capsule, cylinder)    \
  WINNOW_X(cylinder, triangle)   \
  WINNOW_X(cylinder, hull)       \
  WINNOW_X(cylinder, cylinder)
WINNOW_DEFINE_LINK(cylinder, WINNOW_PAIRS)
#undef WINNOW_PAIRS

Answer<ShapeId> ShapePool::add(const CylinderShape& shape) {
  const DefaultFloatEnvironment environment;
  if (!are_lengths({shape.radius, shape.half_length, shape.rounding})) return Status::invalid_shape;
  link_kernels_of_cylinder();
  return PoolRows::put(*this, shape);
}

}  // namespace winnow
