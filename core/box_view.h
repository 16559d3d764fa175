#pragma once

#include <winnow/core/aabb.h>

#include <array>
#include <concepts>
#include <cstddef>
#include <span>

namespace winnow {

/// Boxes where the caller keeps them: six float pointers, one stride in bytes, a count. Nothing is
/// copied to make one, and it must not outlive the memory it looks at.
struct BoxView {
  std::array<const float*, 3> min{};   ///< least corner of the first box: x, y, z
  std::array<const float*, 3> max{};   ///< greatest corner of the first box: x, y, z
  std::size_t stride = sizeof(float);  ///< bytes from one box to the next
  std::size_t count = 0;               ///< boxes

  BoxView() = default;

  /// An array of boxes.
  BoxView(std::span<const Aabb> boxes) noexcept {  // NOLINT(google-explicit-constructor)
    if (boxes.empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      min[axis] = boxes.data()->min.data() + axis;
      max[axis] = boxes.data()->max.data() + axis;
    }
    stride = sizeof(Aabb);
    count = boxes.size();
  }

  /// Any contiguous container of boxes.
  template <typename Boxes>
  requires(std::convertible_to<const Boxes&, std::span<const Aabb>> &&
           !std::same_as<Boxes, std::span<const Aabb>> && !std::same_as<Boxes, BoxView>)
      BoxView(const Boxes& boxes)
  noexcept  // NOLINT(google-explicit-constructor)
      : BoxView(std::span<const Aabb>(boxes)) {}

  /// Columns, or members of any struct: `stride` is the distance in bytes between two boxes.
  BoxView(std::array<const float*, 3> mins, std::array<const float*, 3> maxs, std::size_t boxes,
          std::size_t stride_bytes = sizeof(float)) noexcept
      : min(mins), max(maxs), stride(stride_bytes), count(boxes) {}

  /// Box i, copied out; i is below `count`.
  [[nodiscard]] Aabb operator[](std::size_t i) const noexcept {
    return {{at(min[0], i), at(min[1], i), at(min[2], i)},
            {at(max[0], i), at(max[1], i), at(max[2], i)}};
  }

 private:
  [[nodiscard]] float at(const float* column, std::size_t i) const noexcept {
    return *reinterpret_cast<const float*>(reinterpret_cast<const std::byte*>(column) + i * stride);
  }
};

}  // namespace winnow
