#pragma once

#include "pipeline/kinds/support_extent.h"

namespace winnow {

template <typename Direction>
[[nodiscard]] SupportExtent extent_of(const BoxShape& box, const Direction& direction) noexcept {
  return symmetric(as_eigen(box.half).dot(direction.d.cwiseAbs()) +
                   box.rounding * direction.length());
}
[[nodiscard]] inline double radius_of(const BoxShape& box) noexcept {
  return length_bound(as_eigen(box.half)) + box.rounding;
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
/// Bit i of a corner's number is set on the positive side of axis i. Edge 4 i + k runs along axis
/// i. Face 2 i is the negative, face 2 i + 1 the positive face of axis i.
inline constexpr CornerTable kBoxCorners{
    8,
    {{-1, -1, -1},
     {1, -1, -1},
     {-1, 1, -1},
     {1, 1, -1},
     {-1, -1, 1},
     {1, -1, 1},
     {-1, 1, 1},
     {1, 1, 1}},
    12,
    {{0, 1},
     {2, 3},
     {4, 5},
     {6, 7},
     {0, 2},
     {1, 3},
     {4, 6},
     {5, 7},
     {0, 4},
     {1, 5},
     {2, 6},
     {3, 7}},
    6,
    {4, 4, 4, 4, 4, 4},
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}},
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

[[nodiscard]] inline ShapeCore core_of(const BoxShape& box) noexcept {
  return ShapeCore::of_corners(ShapeKind::box, kBoxCorners, as_eigen(box.half), box.rounding);
}

}  // namespace winnow
