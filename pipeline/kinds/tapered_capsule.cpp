#include "core/threads/float_environment.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/shape_pool_put.h"

namespace winnow {

#define WINNOW_PAIRS(WINNOW_X)          \
  WINNOW_X(sphere, tapered_capsule)     \
  WINNOW_X(half_space, tapered_capsule) \
  WINNOW_X(box, tapered_capsule)        \
  WINNOW_X(capsule, tapered_capsule)    \
  WINNOW_X(triangle, tapered_capsule)   \
  WINNOW_X(hull, tapered_capsule)       \
  WINNOW_X(cylinder, tapered_capsule)   \
  WINNOW_X(cone, tapered_capsule)       \
  WINNOW_X(ellipsoid, tapered_capsule)  \
  WINNOW_X(tapered_capsule, tapered_capsule)
WINNOW_DEFINE_LINK(tapered_capsule, WINNOW_PAIRS)
#undef WINNOW_PAIRS

Answer<ShapeId> ShapePool::add(const TaperedCapsuleShape& shape) {
  const DefaultFloatEnvironment environment;
  if (!are_lengths({shape.radius[0], shape.radius[1], shape.half_length})) {
    return Status::invalid_shape;
  }
  link_kernels_of_tapered_capsule();
  return PoolRows::put(*this, shape);
}

}  // namespace winnow
