#include <winnow/pipeline/shape_pool.h>
#include "core/threads/float_environment.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/shape_pool_put.h"

#include <cmath>

namespace winnow {

#define WINNOW_PAIRS(WINNOW_X)   \
  WINNOW_X(sphere, triangle)     \
  WINNOW_X(box, triangle)        \
  WINNOW_X(triangle, half_space) \
  WINNOW_X(capsule, triangle)    \
  WINNOW_X(triangle, triangle)
WINNOW_DEFINE_LINK(triangle, WINNOW_PAIRS)
#undef WINNOW_PAIRS

Answer<ShapeId> ShapePool::add(const TriangleShape& shape) {
  const DefaultFloatEnvironment environment;
  if (!are_lengths({shape.rounding})) return Status::invalid_shape;
  for (const auto& vertex : shape.vertex) {
    for (const double v : vertex) {
      if (!std::isfinite(v)) return Status::invalid_shape;
    }
  }
  link_kernels_of_triangle();
  return PoolRows::put(*this, shape);
}

void link_triangle_kernels() noexcept {
  link_kernels_of_triangle();
}

}  // namespace winnow
