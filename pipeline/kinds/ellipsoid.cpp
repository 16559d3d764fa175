#include "core/threads/float_environment.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/shape_pool_put.h"

namespace winnow {

#define WINNOW_PAIRS(WINNOW_X)    \
  WINNOW_X(sphere, ellipsoid)     \
  WINNOW_X(half_space, ellipsoid) \
  WINNOW_X(box, ellipsoid)        \
  WINNOW_X(capsule, ellipsoid)    \
  WINNOW_X(triangle, ellipsoid)   \
  WINNOW_X(hull, ellipsoid)       \
  WINNOW_X(cylinder, ellipsoid)   \
  WINNOW_X(cone, ellipsoid)       \
  WINNOW_X(ellipsoid, ellipsoid)
WINNOW_DEFINE_LINK(ellipsoid, WINNOW_PAIRS)
#undef WINNOW_PAIRS

Answer<ShapeId> ShapePool::add(const EllipsoidShape& shape) {
  const DefaultFloatEnvironment environment;
  if (!are_lengths({shape.radius[0], shape.radius[1], shape.radius[2], shape.rounding})) {
    return Status::invalid_shape;
  }
  link_kernels_of_ellipsoid();
  return PoolRows::put(*this, shape);
}

}  // namespace winnow
