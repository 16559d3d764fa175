#pragma once

#include "pipeline/kinds/support_extent.h"

namespace winnow {

template <typename Direction>
[[nodiscard]] SupportExtent extent_of(const BoxShape& box, const Direction& direction) noexcept {
  return symmetric(Eigen::Vector3d::Map(box.half).dot(direction.d.cwiseAbs()) +
                   box.rounding * direction.length());
}
[[nodiscard]] inline double radius_of(const BoxShape& box) noexcept {
  return length_bound(Eigen::Vector3d::Map(box.half)) + box.rounding;
}
[[nodiscard]] inline double rounding_of(const BoxShape& box) noexcept {
  return box.rounding;
}
[[nodiscard]] inline double inner_radius_of(const BoxShape& box) noexcept {
  return std::min({box.half[0], box.half[1], box.half[2]}) + box.rounding;
}
[[nodiscard]] inline double size_of(const BoxShape& box) noexcept {
  return std::max({box.half[0], box.half[1], box.half[2], box.rounding});
}
[[nodiscard]] inline ShapeCore core_of(const BoxShape& box) noexcept {
  return ShapeCore::of_lengths(CoreKind::box, Eigen::Vector3d::Map(box.half), box.rounding);
}

}  // namespace winnow
