#pragma once

#include <winnow/core/vectors.h>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <type_traits>
#include <utility>

namespace winnow {

namespace detail {

/// Returns element `i` of a column whose elements are `stride` bytes apart.
template <typename T>
[[nodiscard]] inline T strided(const T* column, std::size_t i, std::size_t stride) noexcept {
  return *reinterpret_cast<const T*>(reinterpret_cast<const std::byte*>(column) + i * stride);
}

/// A contiguous container.
template <typename Elements>
concept Contiguous = requires(const Elements& elements) {
  { std::size(elements) } -> std::convertible_to<std::size_t>;
  *std::data(elements);
};
template <typename Elements>
using ElementOf = std::remove_cvref_t<decltype(*std::data(std::declval<const Elements&>()))>;

/// Returns the address of the first number of an element: of the number itself, of a vector with
/// data(), or of an array; null for any other type.
template <typename Element>
[[nodiscard]] constexpr auto first_number(const Element* element) noexcept {
  if constexpr (std::is_arithmetic_v<Element>) {
    return element;
  } else if constexpr (requires { element->data() + 1; }) {
    return element->data();
  } else if constexpr (std::is_array_v<Element>) {
    return &(*element)[0];
  } else {
    return nullptr;
  }
}

/// Returns the address of a coordinate of a point that first_number takes, or that is a struct with
/// members x, y and z; null for any other type.
template <typename Point>
[[nodiscard]] constexpr auto coordinate_of(const Point* point, std::size_t axis) noexcept {
  if constexpr (requires { std::array{&point->x, &point->y, &point->z}; }) {
    return std::array{&point->x, &point->y, &point->z}[axis];
  } else if constexpr (std::is_null_pointer_v<decltype(first_number(point))>) {
    return nullptr;
  } else {
    return first_number(point) + axis;
  }
}

/// True for Eigen vectors and maps of them without gaps, and for matrices without gaps that have
/// one point or triangle after the other: three rows by columns, three columns by rows.
template <typename Elements>
concept Packed = int{Elements::InnerStrideAtCompileTime} == 1 &&
                 (static_cast<bool>(Elements::IsVectorAtCompileTime) ||
                  (int{Elements::OuterStrideAtCompileTime} == 3 &&
                   int{Elements::IsRowMajor ? Elements::ColsAtCompileTime
                                            : Elements::RowsAtCompileTime} == 3));

/// True unless an Eigen matrix of numbers stores the three of a point or triangle apart.
template <typename Elements>
concept ThreeByThree = !requires {
  Elements::IsRowMajor;
}
|| Packed<Elements>;

/// A contiguous container of points, or of their coordinates, in T.
template <typename Points, typename T>
concept PointsOf = Contiguous<Points> && ThreeByThree<Points> && requires(const Points& points) {
  { coordinate_of(std::data(points), 0) } -> std::same_as<const T*>;
};

/// A contiguous container of points in float or double.
template <typename Points>
concept ArrayOfPoints = PointsOf<Points, float> || PointsOf<Points, double>;

/// An index of 16 or 32 bits.
template <typename T>
concept Index = std::is_integral_v<T> &&(sizeof(T) == 2 || sizeof(T) == 4);

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
  /// Views any contiguous container of points in float or double: winnow's vectors, Eigen's, and
  /// others whose data() points to their coordinates, arrays of 3, and structs with members x, y
  /// and z; or of numbers, where x, y and z of each point follow one another (one or two extra
  /// numbers are ignored).
  template <detail::Contiguous Points>
  PointView(const Points& points) noexcept {  // NOLINT(google-explicit-constructor)
    using Point = detail::ElementOf<Points>;
    static_assert(detail::ArrayOfPoints<Points>,
                  "a PointView takes a contiguous container of points with data(), of arrays "
                  "float[3] or double[3], of structs with members x, y and z, or of float or "
                  "double x, y, z, x, y, z, ...");
    if constexpr (detail::ArrayOfPoints<Points>) {
      constexpr std::size_t kElements = std::is_arithmetic_v<Point> ? 3 : 1;  // of a point
      count = static_cast<std::size_t>(std::size(points)) / kElements;
      stride = kElements * sizeof(Point);
      for (std::size_t axis = 0; axis < 3 && count != 0; ++axis) {
        if constexpr (detail::PointsOf<Points, float>) {
          single[axis] = detail::coordinate_of(std::data(points), axis);
        } else {
          precise[axis] = detail::coordinate_of(std::data(points), axis);
        }
      }
    }
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
    if (single[axis] != nullptr) return detail::to_double(detail::strided(single[axis], i, stride));
    return detail::strided(precise[axis], i, stride);
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
  /// Views any contiguous container of indices of 16 or 32 bits, signed or unsigned, where the
  /// three of each triangle follow one another (one or two extra ones are ignored); or of
  /// triangles: arrays of 3 indices, and vectors whose data() points to three. Negative indices are
  /// of no vertex.
  template <detail::Contiguous Corners>
  IndexView(const Corners& corners) noexcept {  // NOLINT(google-explicit-constructor)
    using Element = detail::ElementOf<Corners>;
    const auto* const first = detail::first_number(std::data(corners));
    using Pointer = std::remove_cv_t<decltype(first)>;
    using Number = std::remove_const_t<std::remove_pointer_t<Pointer>>;
    static_assert(detail::Index<Number> && detail::ThreeByThree<Corners>,
                  "an IndexView takes a contiguous container of integers of 16 or 32 bits, three "
                  "for each triangle, or of arrays of three");
    if constexpr (detail::Index<Number>) {
      constexpr bool kSingle = std::same_as<Element, Number>;
      static_assert(kSingle || sizeof(Element) >= 3 * sizeof(Number), "a triangle has 3 indices");
      count = static_cast<std::size_t>(std::size(corners)) / (kSingle ? 3 : 1);
      stride = kSingle ? 3 * sizeof(Number) : sizeof(Element);
      if (count == 0) return;
      if constexpr (sizeof(Number) == 4) {
        wide = reinterpret_cast<const std::uint32_t*>(first);
      } else {
        narrow = reinterpret_cast<const std::uint16_t*>(first);
      }
    }
  }
  /// Views indices as members of any struct.
  IndexView(const std::uint32_t* corners, std::size_t triangles, std::size_t stride_bytes) noexcept
      : wide(corners), stride(stride_bytes), count(triangles) {}
  /// Views indices of 16 bits as members of any struct.
  IndexView(const std::uint16_t* corners, std::size_t triangles, std::size_t stride_bytes) noexcept
      : narrow(corners), stride(stride_bytes), count(triangles) {}

  /// Returns the vertex index of corner k, 0 to 2, of a triangle below `count`.
  [[nodiscard]] std::uint32_t corner(std::size_t triangle, std::size_t k) const noexcept {
    if (wide != nullptr) return detail::strided(wide + k, triangle, stride);
    return detail::strided(narrow + k, triangle, stride);
  }
};

}  // namespace winnow
