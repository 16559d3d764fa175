#pragma once

#include <winnow/core/aabb.h>

#include <array>
#include <concepts>
#include <cstddef>
#include <span>

namespace winnow {

/// Non-owning view of boxes in the caller's memory: six float pointers, one stride in bytes and a
/// count. It copies nothing and must not outlive that memory.
struct BoxView {
  std::array<const float*, 3> min{};   ///< lower corner of the first box: x, y, z
  std::array<const float*, 3> max{};   ///< upper corner of the first box: x, y, z
  std::size_t stride = sizeof(float);  ///< bytes from one box to the next
  std::size_t count = 0;               ///< number of boxes

  BoxView() = default;

  /// Views an array of boxes.
  BoxView(std::span<const Aabb> boxes) noexcept {  // NOLINT(google-explicit-constructor)
    if (boxes.empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      min[axis] = boxes.data()->min.data() + axis;
      max[axis] = boxes.data()->max.data() + axis;
    }
    stride = sizeof(Aabb);
    count = boxes.size();
  }

  /// Views any contiguous container of boxes.
  template <typename Boxes>
  requires(std::convertible_to<const Boxes&, std::span<const Aabb>> &&
           !std::same_as<Boxes, std::span<const Aabb>> && !std::same_as<Boxes, BoxView>)
      BoxView(const Boxes& boxes)
  noexcept  // NOLINT(google-explicit-constructor)
      : BoxView(std::span<const Aabb>(boxes)) {}

  /// Views columns, or members of any struct: `stride_bytes` is the distance between two boxes.
  BoxView(std::array<const float*, 3> mins, std::array<const float*, 3> maxs, std::size_t boxes,
          std::size_t stride_bytes = sizeof(float)) noexcept
      : min(mins), max(maxs), stride(stride_bytes), count(boxes) {}

  /// Returns a copy of box i; i must be below `count`.
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
