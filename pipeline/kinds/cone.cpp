#include "core/threads/float_environment.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/shape_pool_put.h"

namespace winnow {

#define WINNOW_PAIRS(WINNOW_X) \
  WINNOW_X(sphere, cone)       \
  WINNOW_X(box, cone)          \
  WINNOW_X(cone, half_space)   \
  WINNOW_X(capsule, cone)      \
  WINNOW_X(cone, triangle)     \
  WINNOW_X(cone, hull)         \
  WINNOW_X(cylinder, cone)     \
  WINNOW_X(cone, cone)
WINNOW_DEFINE_LINK(cone, WINNOW_PAIRS)
#undef WINNOW_PAIRS

Answer<ShapeId> ShapePool::add(const ConeShape& shape) {
  const DefaultFloatEnvironment environment;
  if (!are_lengths({shape.radius, shape.half_length, shape.rounding})) return Status::invalid_shape;
  link_kernels_of_cone();
  return PoolRows::put(*this, shape);
}

}  // namespace winnow
