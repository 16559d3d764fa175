#include "tests/pipeline/user_shapes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace winnow::test {
namespace {

void farthest_of_block(const UserShape& block, const double* direction, double* point) {
  for (int i = 0; i < 3; ++i) point[i] = std::copysign(block.size[i], direction[i]);
}

void farthest_of_drum(const UserShape& drum, const double* direction, double* point) {
  const double across = std::hypot(direction[0], direction[1]);
  for (int i = 0; i < 2; ++i) {
    point[i] = across > 0.0 ? drum.size[0] * (direction[i] / across) : 0.0;
  }
  point[2] = std::copysign(drum.size[2], direction[2]);
}

void farthest_of_egg(const UserShape& egg, const double* direction, double* point) {
  double share[3];
  double most = 0.0;
  for (int i = 0; i < 3; ++i) {
    share[i] = egg.size[i] * direction[i];
    most = std::max(most, std::abs(share[i]));
  }
  if (!(most > 0.0)) {
    std::fill_n(point, 3, 0.0);
    return;
  }
  for (double& x : share) x /= most;
  const double length = std::hypot(share[0], share[1], share[2]);
  for (int i = 0; i < 3; ++i) point[i] = egg.size[i] * (share[i] / length);
}

void farthest_of_corners(const UserShape& hull, const double* direction, double* point) {
  double most = -HUGE_VAL;
  for (std::size_t i = 0; i < hull.corner.size(); i += 3) {
    const double* x = hull.corner.data() + i;
    const double along = x[0] * direction[0] + x[1] * direction[1] + x[2] * direction[2];
    if (!(along > most)) continue;
    most = along;
    std::copy_n(x, 3, point);
  }
}

void farthest(const void* context, const double direction[3], double point[3]) {
  const auto& set = *static_cast<const UserShape*>(context);
  switch (set.form) {
    case UserShape::block:
      return farthest_of_block(set, direction, point);
    case UserShape::drum:
      return farthest_of_drum(set, direction, point);
    case UserShape::egg:
      return farthest_of_egg(set, direction, point);
    case UserShape::corners:
      return farthest_of_corners(set, direction, point);
  }
}

double radius_of(const UserShape& set) {
  switch (set.form) {
    case UserShape::block:
      return std::hypot(set.size[0], set.size[1], set.size[2]);
    case UserShape::drum:
      return std::hypot(set.size[0], set.size[2]);
    case UserShape::egg:
      return *std::max_element(set.size, set.size + 3);
    case UserShape::corners:
      break;
  }
  double most = 0.0;
  for (std::size_t i = 0; i < set.corner.size(); i += 3) {
    most = std::max(most, std::hypot(set.corner[i], set.corner[i + 1], set.corner[i + 2]));
  }
  return most;
}

}  // namespace

SupportShape shape_of(const UserShape& set, double rounding) {
  // The radius must cover the rounding of the support functions.
  return {farthest, &set, radius_of(set) * (1.0 + 1e-15), rounding};
}

}  // namespace winnow::test
