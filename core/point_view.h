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

/// A contiguous container whose elements store x, y and z one after another.
template <typename Points>
concept ArrayOfPoints = requires(const Points& points) {
  { std::size(points) } -> std::convertible_to<std::size_t>;
  std::data(points)->x() + std::data(points)->y() + std::data(points)->z();
  requires std::same_as<decltype(std::data(points)->data()), const float*> ||
      std::same_as<decltype(std::data(points)->data()), const double*>;
};

}  // namespace detail

/// Non-owning view of points in the caller's memory: three pointers to float or to double, and the
/// distance in bytes from one point to the next. It copies nothing and must not outlive that
/// memory.
struct PointView {
  std::array<const float*, 3> single{};  ///< coordinates of the first point in float: x, y, z
  /// The coordinates in double, used if `single` is null.
  std::array<const double*, 3> precise{};
  /// Bytes from one point to the next.
  std::size_t stride = sizeof(float);
  std::size_t count = 0;  ///< number of points

  PointView() = default;
  /// Views any contiguous container of vectors: winnow's, Eigen's, and others whose data() points
  /// to their coordinates in float or double.
  template <detail::ArrayOfPoints Points>
  PointView(const Points& points) noexcept  // NOLINT(google-explicit-constructor)
      : stride(sizeof(*std::data(points))), count(std::size(points)) {
    if (count == 0) return;
    for (std::size_t axis = 0; axis < 3; ++axis) set_column(axis, std::data(points)->data() + axis);
  }
  /// Views columns of floats, or float members of any struct.
  PointView(std::array<const float*, 3> columns, std::size_t points,
            std::size_t stride_bytes = sizeof(float)) noexcept
      : single(columns), stride(stride_bytes), count(points) {}
  /// Views columns of doubles, or double members of any struct.
  PointView(std::array<const double*, 3> columns, std::size_t points,
            std::size_t stride_bytes = sizeof(double)) noexcept
      : precise(columns), stride(stride_bytes), count(points) {}

  /// Returns point `i`.
  [[nodiscard]] Vec3d operator[](std::size_t i) const noexcept {
    return {coordinate(i, 0), coordinate(i, 1), coordinate(i, 2)};
  }
  /// Returns coordinate `axis` of point `i`.
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

/// Non-owning view of triangles as vertex indices in the caller's memory: the three indices of a
/// triangle are contiguous, `stride` bytes after the indices of the previous triangle.
struct IndexView {
  const std::uint32_t* wide = nullptr;  ///< indices of the first triangle
  /// The indices in 16 bits, used if `wide` is null.
  const std::uint16_t* narrow = nullptr;
  /// Bytes from one triangle to the next.
  std::size_t stride = 3 * sizeof(std::uint32_t);
  std::size_t count = 0;  ///< number of triangles

  IndexView() = default;
  /// Views three indices per triangle, one triangle after another. One or two extra indices are
  /// ignored.
  IndexView(std::span<const std::uint32_t> corners) noexcept  // NOLINT(google-explicit-constructor)
      : wide(corners.data()), count(corners.size() / 3) {}
  /// As above, for indices of 16 bits.
  IndexView(std::span<const std::uint16_t> corners) noexcept  // NOLINT(google-explicit-constructor)
      : narrow(corners.data()), stride(3 * sizeof(std::uint16_t)), count(corners.size() / 3) {}
  /// Views indices as members of any struct.
  IndexView(const std::uint32_t* corners, std::size_t triangles, std::size_t stride_bytes) noexcept
      : wide(corners), stride(stride_bytes), count(triangles) {}
  /// Views indices of 16 bits as members of any struct.
  IndexView(const std::uint16_t* corners, std::size_t triangles, std::size_t stride_bytes) noexcept
      : narrow(corners), stride(stride_bytes), count(triangles) {}

  /// Returns the vertex index of corner k, 0 to 2, of a triangle below `count`.
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
