#pragma once

#include <winnow/core/rounding.h>
#include <winnow/core/vec3.h>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

namespace detail {

/// Whose elements have coordinates that lie one after another.
template <typename Points>
concept ArrayOfPoints = requires(const Points& points) {
  { std::size(points) } -> std::convertible_to<std::size_t>;
  std::data(points)->x() + std::data(points)->y() + std::data(points)->z();
  requires std::same_as<decltype(std::data(points)->data()), const float*> ||
      std::same_as<decltype(std::data(points)->data()), const double*>;
};

}  // namespace detail

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
  /// An array, or any contiguous container, of vectors: winnow's, those of Eigen, and others whose
  /// data() leads to their coordinates, in float or in double.
  template <detail::ArrayOfPoints Points>
  PointView(const Points& points) noexcept  // NOLINT(google-explicit-constructor)
      : stride(sizeof(*std::data(points))), count(std::size(points)) {
    if (count == 0) return;
    for (std::size_t axis = 0; axis < 3; ++axis) set_column(axis, std::data(points)->data() + axis);
  }
  /// Columns, or members of any struct.
  PointView(std::array<const float*, 3> columns, std::size_t points,
            std::size_t stride_bytes = sizeof(float)) noexcept
      : single(columns), stride(stride_bytes), count(points) {}
  /// Columns in double, or members of any struct.
  PointView(std::array<const double*, 3> columns, std::size_t points,
            std::size_t stride_bytes = sizeof(double)) noexcept
      : precise(columns), stride(stride_bytes), count(points) {}

  /// Point `i`.
  [[nodiscard]] Vec3d operator[](std::size_t i) const noexcept {
    return {coordinate(i, 0), coordinate(i, 1), coordinate(i, 2)};
  }
  /// Coordinate `axis` of point `i`.
  [[nodiscard]] double coordinate(std::size_t i, std::size_t axis) const noexcept {
    if (single[axis] != nullptr) return to_double(at(single[axis], i));
    return at(precise[axis], i);
  }

 private:
  void set_column(std::size_t axis, const float* column) noexcept { single[axis] = column; }
  void set_column(std::size_t axis, const double* column) noexcept { precise[axis] = column; }

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
