#pragma once

#include <winnow/pipeline/narrow_result.h>

#include <span>

namespace winnow::c {

/// Returns null for an empty column.
template <typename T>
[[nodiscard]] const T* column(std::span<const T> values) noexcept {
  return values.empty() ? nullptr : values.data();
}

/// Sets the columns of contact points, without a copy.
template <typename Shown>
void show_points(const ContactColumns& points, Shown& shown) noexcept {
  if (points.size() == 0) return;
  for (std::size_t axis = 0; axis < 3; ++axis) shown.position[axis] = points.position[axis].data();
  shown.depth = points.depth.data();
  shown.feature = points.feature.data();
}

}  // namespace winnow::c
