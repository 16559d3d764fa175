#pragma once

#include <winnow/core/export.h>

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Points where the caller keeps them: three pointers to float or to double, and the distance in
/// bytes from one point to the next. Nothing is copied to make one, and it must not outlive the
/// memory it looks at.
struct PointView {
  std::array<const float*, 3> single{};  ///< coordinates of the first point in float: x, y, z
  /// Read where `single` is null.
  std::array<const double*, 3> precise{};
  /// Bytes from one point to the next.
  std::size_t stride = sizeof(float);
  std::size_t count = 0;  ///< points

  PointView() = default;
  /// An array of points in float.
  PointView(
      std::span<const Eigen::Vector3f> points) noexcept  // NOLINT(google-explicit-constructor)
      : stride(sizeof(Eigen::Vector3f)), count(points.size()) {
    if (points.empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis) single[axis] = points.data()->data() + axis;
  }
  /// An array of points in double.
  PointView(
      std::span<const Eigen::Vector3d> points) noexcept  // NOLINT(google-explicit-constructor)
      : stride(sizeof(Eigen::Vector3d)), count(points.size()) {
    if (points.empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis) precise[axis] = points.data()->data() + axis;
  }
  /// Columns, or members of any struct.
  PointView(std::array<const float*, 3> columns, std::size_t points,
            std::size_t stride_bytes = sizeof(float)) noexcept
      : single(columns), stride(stride_bytes), count(points) {}
  /// Columns in double, or members of any struct.
  PointView(std::array<const double*, 3> columns, std::size_t points,
            std::size_t stride_bytes = sizeof(double)) noexcept
      : precise(columns), stride(stride_bytes), count(points) {}

  /// Coordinate `axis` of point i, below `count`, as a double.
  [[nodiscard]] double coordinate(std::size_t i, std::size_t axis) const noexcept {
    if (single[axis] != nullptr) return static_cast<double>(at(single[axis], i));
    return at(precise[axis], i);
  }

 private:
  template <typename T>
  [[nodiscard]] T at(const T* column, std::size_t i) const noexcept {
    return *reinterpret_cast<const T*>(reinterpret_cast<const std::byte*>(column) + i * stride);
  }
};

/// Triangles as corners' numbers where the caller keeps them: the three of triangle i are
/// contiguous, `stride` bytes after those of triangle i - 1.
struct IndexView {
  const std::uint32_t* wide = nullptr;  ///< corners of the first triangle
  /// Read where `wide` is null.
  const std::uint16_t* narrow = nullptr;
  /// Bytes from one triangle to the next.
  std::size_t stride = 3 * sizeof(std::uint32_t);
  std::size_t count = 0;  ///< triangles

  IndexView() = default;
  /// Three numbers per triangle, one triangle after another. A rest of one or two is not read.
  IndexView(std::span<const std::uint32_t> corners) noexcept  // NOLINT(google-explicit-constructor)
      : wide(corners.data()), count(corners.size() / 3) {}
  /// The same of 16-bit numbers.
  IndexView(std::span<const std::uint16_t> corners) noexcept  // NOLINT(google-explicit-constructor)
      : narrow(corners.data()), stride(3 * sizeof(std::uint16_t)), count(corners.size() / 3) {}
  /// Corners as members of any struct.
  IndexView(const std::uint32_t* corners, std::size_t triangles, std::size_t stride_bytes) noexcept
      : wide(corners), stride(stride_bytes), count(triangles) {}
  /// Corners of 16 bits as members of any struct.
  IndexView(const std::uint16_t* corners, std::size_t triangles, std::size_t stride_bytes) noexcept
      : narrow(corners), stride(stride_bytes), count(triangles) {}

  /// Number of corner k, 0 to 2, of a triangle below `count`.
  [[nodiscard]] std::uint32_t corner(std::size_t triangle, std::size_t k) const noexcept {
    const std::size_t offset = triangle * stride;
    if (wide != nullptr) {
      return reinterpret_cast<const std::uint32_t*>(reinterpret_cast<const std::byte*>(wide) +
                                                    offset)[k];
    }
    return reinterpret_cast<const std::uint16_t*>(reinterpret_cast<const std::byte*>(narrow) +
                                                  offset)[k];
  }
};

}  // namespace winnow
