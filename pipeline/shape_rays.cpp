#include <winnow/pipeline/shape_rays.h>

namespace winnow {

Status cast_ray(const ShapeTables&, ShapeId, const Pose&, const ShapeRay&, ShapeHit&) noexcept {
  return Status::unsupported;
}

}  // namespace winnow
