#include "core/threads/float_environment.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/shape_pool_put.h"

namespace winnow {

#define WINNOW_PAIRS(WINNOW_X) \
  WINNOW_X(sphere, box)        \
  WINNOW_X(box, box)
WINNOW_DEFINE_LINK(box, WINNOW_PAIRS)
#undef WINNOW_PAIRS

Answer<ShapeId> ShapePool::add(const BoxShape& shape) {
  const DefaultFloatEnvironment environment;
  if (!are_lengths({shape.half[0], shape.half[1], shape.half[2], shape.rounding})) {
    return Status::invalid_shape;
  }
  link_kernels_of_box();
  return PoolRows::put(*this, shape);
}

}  // namespace winnow
