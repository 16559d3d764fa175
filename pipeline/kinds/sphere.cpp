#include "core/threads/float_environment.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/shape_pool_put.h"

namespace winnow {

#define WINNOW_PAIRS(WINNOW_X) WINNOW_X(sphere, sphere)
WINNOW_DEFINE_LINK(sphere, WINNOW_PAIRS)
#undef WINNOW_PAIRS

Answer<ShapeId> ShapePool::add(const SphereShape& shape) {
  const DefaultFloatEnvironment environment;
  if (!are_lengths({shape.radius})) return Status::invalid_shape;
  link_kernels_of_sphere();
  return PoolRows::put(*this, shape);
}

}  // namespace winnow
