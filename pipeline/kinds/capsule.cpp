#include "core/threads/float_environment.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/shape_pool_put.h"

namespace winnow {

#define WINNOW_PAIRS(WINNOW_X)  \
  WINNOW_X(sphere, capsule)     \
  WINNOW_X(capsule, box)        \
  WINNOW_X(capsule, half_space) \
  WINNOW_X(capsule, capsule)
WINNOW_DEFINE_LINK(capsule, WINNOW_PAIRS)
#undef WINNOW_PAIRS

Answer<ShapeId> ShapePool::add(const CapsuleShape& shape) {
  const DefaultFloatEnvironment environment;
  if (!are_lengths({shape.radius, shape.half_length})) return Status::invalid_shape;
  link_kernels_of_capsule();
  return PoolRows::put(*this, shape);
}

}  // namespace winnow
