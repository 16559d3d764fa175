#include <winnow/core/volumes.h>

#include "core/numbers/rounding.h"
#include "core/threads/float_environment.h"

namespace winnow {

Aabb Aabb::outward(const Vec3d& min, const Vec3d& max, const Vec3d& origin) noexcept {
  const DefaultFloatEnvironment environment;
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] = round_down(add_down(min[axis], -origin[axis]));
    box.max[axis] = round_up(add_up(max[axis], -origin[axis]));
  }
  return box;
}

}  // namespace winnow
