#pragma once

#include <winnow/core/export.h>

#include <Eigen/Core>
#include <cmath>

namespace winnow {

/// The closed half-space of points p with normal . p + offset >= 0. The normal points inward and
/// has any finite length but zero.
struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitX();
  float offset = 0.0F;

  [[nodiscard]] bool is_valid() const noexcept {
    return normal.allFinite() && std::isfinite(offset) && (normal.array() != 0.0F).any();
  }
};

static_assert(sizeof(Plane) == 16 && alignof(Plane) == 4, "layout must not depend on build flags");

}  // namespace winnow
