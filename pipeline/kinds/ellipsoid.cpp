#include "pipeline/shapes/put_shape.h"

namespace winnow {

Status ShapePool::add(const EllipsoidShape& shape, ShapeId& id) {
  if (!are_lengths({shape.radius[0], shape.radius[1], shape.radius[2], shape.rounding})) {
    return Status::invalid_shape;
  }
  return put(ellipsoids_, ShapeKind::ellipsoid, shape, id);
}

}  // namespace winnow
