#include "pipeline/shapes/put_shape.h"

namespace winnow {

Status ShapePool::add(const TaperedCapsuleShape& shape, ShapeId& id) {
  if (!are_lengths({shape.radius[0], shape.radius[1], shape.half_length})) {
    return Status::invalid_shape;
  }
  return put(tapered_capsules_, ShapeKind::tapered_capsule, shape, id);
}

}  // namespace winnow
