#pragma once

#include <winnow/core/point_view.h>
#include <winnow/core/pose.h>

#include <array>
#include <concepts>
#include <cstddef>
#include <span>

namespace winnow {

/// Non-owning view of poses in the caller's memory: pointers to the three coordinates of positions
/// (double) and to the four of orientations (w, x, y, z; double or float), and the distances in
/// bytes from one pose to the next. It copies nothing and must not outlive that memory. If the view
/// has no orientations, calls that move bodies keep their orientations, and `operator[]` returns
/// poses without rotation.
struct PoseView {
  std::array<const double*, 3> position{};  ///< of the first pose: x, y, z
  /// Bytes from one position to the next.
  std::size_t position_stride = sizeof(double);
  std::array<const double*, 4> orientation{};  ///< of the first pose: w, x, y, z
  /// The orientations in float, used if `orientation` is null.
  std::array<const float*, 4> orientation_float{};
  /// Bytes from one orientation to the next.
  std::size_t orientation_stride = sizeof(double);
  std::size_t count = 0;  ///< number of poses

  PoseView() = default;

  /// Views an array of poses.
  PoseView(std::span<const Pose> poses) noexcept {  // NOLINT(google-explicit-constructor)
    if (poses.empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis)
      position[axis] = poses.data()->position.data() + axis;
    for (std::size_t k = 0; k < 4; ++k) orientation[k] = poses.data()->orientation.data() + k;
    position_stride = orientation_stride = sizeof(Pose);
    count = poses.size();
  }

  /// Views any contiguous container of poses.
  template <typename Poses>
  requires(std::convertible_to<const Poses&, std::span<const Pose>> &&
           !std::same_as<Poses, std::span<const Pose>> && !std::same_as<Poses, PoseView>)
      PoseView(const Poses& poses)
  noexcept  // NOLINT(google-explicit-constructor)
      : PoseView(std::span<const Pose>(poses)) {}

  /// Views positions without orientations.
  PoseView(std::array<const double*, 3> positions, std::size_t poses,
           std::size_t position_bytes = sizeof(double)) noexcept
      : position(positions), position_stride(position_bytes), count(poses) {}
  /// Views an array of positions, which are vectors in double, without orientations; see PointView.
  template <detail::ArrayOfPoints Points>
  [[nodiscard]] static PoseView of_positions(const Points& positions) noexcept {
    static_assert(detail::PointsOf<Points, double>, "positions of bodies are in double");
    const PointView points(positions);
    return {points.precise, points.count, points.stride};
  }

  /// Views columns, or members of any struct.
  PoseView(std::array<const double*, 3> positions, std::array<const float*, 4> orientations,
           std::size_t poses, std::size_t position_bytes = sizeof(double),
           std::size_t orientation_bytes = sizeof(float)) noexcept
      : position(positions),
        position_stride(position_bytes),
        orientation_float(orientations),
        orientation_stride(orientation_bytes),
        count(poses) {}
  /// As above, with orientations in double.
  PoseView(std::array<const double*, 3> positions, std::array<const double*, 4> orientations,
           std::size_t poses, std::size_t position_bytes = sizeof(double),
           std::size_t orientation_bytes = sizeof(double)) noexcept
      : position(positions),
        position_stride(position_bytes),
        orientation(orientations),
        orientation_stride(orientation_bytes),
        count(poses) {}

  /// Returns true if the view has orientations.
  [[nodiscard]] bool has_orientations() const noexcept {
    return orientation[0] != nullptr || orientation_float[0] != nullptr;
  }
  /// Returns a copy of pose i; i must be below `count`.
  [[nodiscard]] Pose operator[](std::size_t i) const noexcept {
    Pose pose;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      pose.position[axis] = at(position[axis], i, position_stride);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      if (orientation[k] != nullptr) {
        pose.orientation[k] = at(orientation[k], i, orientation_stride);
      } else if (orientation_float[k] != nullptr) {
        pose.orientation[k] = static_cast<double>(at(orientation_float[k], i, orientation_stride));
      }
    }
    return pose;
  }

 private:
  template <typename T>
  [[nodiscard]] static T at(const T* column, std::size_t i, std::size_t stride) noexcept {
    return *reinterpret_cast<const T*>(reinterpret_cast<const std::byte*>(column) + i * stride);
  }
};

}  // namespace winnow
