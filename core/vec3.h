#pragma once

// BasicVec3, the vector type of public headers (Vec3f, Vec3d). It converts from and to Eigen's
// vectors without including Eigen.
#include <winnow/core/export.h>

#include <array>
#include <cmath>
#include <concepts>
#include <type_traits>

namespace winnow {

template <typename T>
class BasicVec3;

namespace detail {

/// A number that converts to T without loss, such as float to double.
template <typename Number, typename T>
concept FitsIn = std::is_arithmetic_v<std::remove_cvref_t<Number>> && requires(Number number) {
  T{number};
};

/// A vector type with x(), y() and z(), except BasicVec3 of the same number: vectors and
/// expressions of Eigen, and user types with this interface.
template <typename Vector, typename T>
concept HasAccessors = !std::derived_from<Vector, BasicVec3<T>> && requires(const Vector& v) {
  { v.x() } -> FitsIn<T>;
  { v.y() } -> FitsIn<T>;
  { v.z() } -> FitsIn<T>;
};

/// A struct with members x, y and z.
template <typename Vector, typename T>
concept HasMembers = requires(const Vector& v) {
  { v.x } -> FitsIn<T>;
  { v.y } -> FitsIn<T>;
  { v.z } -> FitsIn<T>;
};

/// An Eigen vector that stores three elements. It is recognised by its members, without Eigen's
/// headers.
template <typename Vector, typename T>
concept EigenVector = requires {
  requires std::same_as<typename Vector::Scalar, T>;
  requires std::same_as<typename Vector::PlainObject, Vector>;
  requires Vector::SizeAtCompileTime == 3;
};

/// Evaluates an Eigen expression once; returns anything else as it is.
template <typename Expression>
[[nodiscard]] constexpr decltype(auto) value_of(const Expression& expression) noexcept {
  if constexpr (requires { expression.eval(); }) {
    return expression.eval();
  } else {
    return (expression);
  }
}

}  // namespace detail

/// A point or direction in space: three contiguous numbers. Arrays of three numbers, structs with
/// members x, y and z, and vectors with x(), y() and z(), such as Eigen's, convert to it if no
/// number can lose digits; it converts to Eigen vectors. <winnow/core/eigen.h> views it as an Eigen
/// vector in place.
template <typename T>
class BasicVec3 {
  static_assert(std::is_floating_point_v<T>);

 public:
  /// Creates the zero vector.
  constexpr BasicVec3() noexcept = default;
  /// Creates a vector from its coordinates.
  constexpr BasicVec3(T x, T y, T z) noexcept : at_{x, y, z} {}
  /// Creates a vector from three contiguous numbers.
  explicit constexpr BasicVec3(const T* numbers) noexcept
      : at_{numbers[0], numbers[1], numbers[2]} {}
  /// Converts three numbers of the caller.
  /// @{
  template <detail::FitsIn<T> Number>
  constexpr BasicVec3(const Number (&numbers)[3]) noexcept  // NOLINT(google-explicit-constructor)
      : at_{numbers[0], numbers[1], numbers[2]} {}
  template <detail::FitsIn<T> Number>
  constexpr BasicVec3(  // NOLINT(google-explicit-constructor)
      const std::array<Number, 3>& numbers) noexcept
      : at_{numbers[0], numbers[1], numbers[2]} {}
  template <detail::HasMembers<T> Vector>
  constexpr BasicVec3(const Vector& v) noexcept  // NOLINT(google-explicit-constructor)
      : at_{v.x, v.y, v.z} {}
  template <detail::HasAccessors<T> Vector>
  constexpr BasicVec3(const Vector& other) noexcept {  // NOLINT(google-explicit-constructor)
    decltype(auto) v = detail::value_of(other);
    at_[0] = v.x();
    at_[1] = v.y();
    at_[2] = v.z();
  }
  /// @}
  /// Converts to an Eigen vector.
  template <detail::EigenVector<T> Vector>
  operator Vector() const noexcept {  // NOLINT(google-explicit-constructor)
    return Vector(at_[0], at_[1], at_[2]);
  }

  /// Returns a vector whose three coordinates are `value`.
  [[nodiscard]] static constexpr BasicVec3 constant(T value) noexcept {
    return {value, value, value};
  }

  [[nodiscard]] constexpr T x() const noexcept { return at_[0]; }  ///< first coordinate
  [[nodiscard]] constexpr T y() const noexcept { return at_[1]; }  ///< second coordinate
  [[nodiscard]] constexpr T z() const noexcept { return at_[2]; }  ///< third coordinate
  [[nodiscard]] constexpr T& x() noexcept { return at_[0]; }       ///< first coordinate, writable
  [[nodiscard]] constexpr T& y() noexcept { return at_[1]; }       ///< second coordinate, writable
  [[nodiscard]] constexpr T& z() noexcept { return at_[2]; }       ///< third coordinate, writable

  /// Coordinate `axis`, 0..2.
  template <std::integral Index>
  [[nodiscard]] constexpr T operator[](Index axis) const noexcept {
    return at_[axis];
  }
  /// Writable coordinate `axis`, 0..2.
  template <std::integral Index>
  [[nodiscard]] constexpr T& operator[](Index axis) noexcept {
    return at_[axis];
  }

  /// Returns a pointer to the three contiguous coordinates.
  [[nodiscard]] constexpr const T* data() const noexcept { return at_; }
  /// Returns a writable pointer to the three contiguous coordinates.
  [[nodiscard]] constexpr T* data() noexcept { return at_; }

  /// Iterators over the three coordinates.
  /// @{
  [[nodiscard]] constexpr const T* begin() const noexcept { return at_; }
  [[nodiscard]] constexpr const T* end() const noexcept { return at_ + 3; }
  [[nodiscard]] constexpr T* begin() noexcept { return at_; }
  [[nodiscard]] constexpr T* end() noexcept { return at_ + 3; }
  /// @}

  /// Returns the vector with each coordinate converted to another type, rounded to nearest.
  template <typename Other>
  [[nodiscard]] constexpr BasicVec3<Other> cast() const noexcept {
    return {static_cast<Other>(at_[0]), static_cast<Other>(at_[1]), static_cast<Other>(at_[2])};
  }

  /// Returns true if no coordinate is infinite or NaN.
  [[nodiscard]] constexpr bool all_finite() const noexcept {
    return at_[0] - at_[0] == T{0} && at_[1] - at_[1] == T{0} && at_[2] - at_[2] == T{0};
  }
  /// Returns true if all coordinates are 0.
  [[nodiscard]] constexpr bool is_zero() const noexcept {
    return at_[0] == T{0} && at_[1] == T{0} && at_[2] == T{0};
  }

  /// Returns the dot product, summed in the order x, y, z.
  [[nodiscard]] constexpr T dot(const BasicVec3& other) const noexcept {
    return at_[0] * other.at_[0] + at_[1] * other.at_[1] + at_[2] * other.at_[2];
  }
  /// Returns the cross product.
  [[nodiscard]] constexpr BasicVec3 cross(const BasicVec3& other) const noexcept {
    return {at_[1] * other.at_[2] - at_[2] * other.at_[1],
            at_[2] * other.at_[0] - at_[0] * other.at_[2],
            at_[0] * other.at_[1] - at_[1] * other.at_[0]};
  }
  /// Returns the squared length.
  [[nodiscard]] constexpr T squared_norm() const noexcept { return dot(*this); }
  /// Returns the length.
  [[nodiscard]] T norm() const noexcept { return std::sqrt(squared_norm()); }

  /// Returns the component-wise minimum; if a coordinate of either vector is NaN, the result has
  /// the coordinate of this vector.
  [[nodiscard]] constexpr BasicVec3 min(const BasicVec3& other) const noexcept {
    return joined(other, [](T a, T b) { return b < a ? b : a; });
  }
  /// Returns the component-wise maximum; if a coordinate of either vector is NaN, the result has
  /// the coordinate of this vector.
  [[nodiscard]] constexpr BasicVec3 max(const BasicVec3& other) const noexcept {
    return joined(other, [](T a, T b) { return a < b ? b : a; });
  }
  /// Returns the component-wise absolute values.
  [[nodiscard]] constexpr BasicVec3 abs() const noexcept {
    return joined(*this, [](T a, T) { return a < T{0} ? -a : a + T{0}; });
  }

  /// Component-wise arithmetic.
  /// @{
  constexpr BasicVec3& operator+=(const BasicVec3& other) noexcept { return *this = *this + other; }
  constexpr BasicVec3& operator-=(const BasicVec3& other) noexcept { return *this = *this - other; }
  constexpr BasicVec3& operator*=(T factor) noexcept { return *this = *this * factor; }
  constexpr BasicVec3& operator/=(T divisor) noexcept { return *this = *this / divisor; }

  [[nodiscard]] friend constexpr BasicVec3 operator-(const BasicVec3& a) noexcept {
    return {-a.at_[0], -a.at_[1], -a.at_[2]};
  }
  [[nodiscard]] friend constexpr BasicVec3 operator+(const BasicVec3& a,
                                                     const BasicVec3& b) noexcept {
    return a.joined(b, [](T p, T q) { return p + q; });
  }
  [[nodiscard]] friend constexpr BasicVec3 operator-(const BasicVec3& a,
                                                     const BasicVec3& b) noexcept {
    return a.joined(b, [](T p, T q) { return p - q; });
  }
  [[nodiscard]] friend constexpr BasicVec3 operator*(const BasicVec3& a, T factor) noexcept {
    return {a.at_[0] * factor, a.at_[1] * factor, a.at_[2] * factor};
  }
  [[nodiscard]] friend constexpr BasicVec3 operator*(T factor, const BasicVec3& a) noexcept {
    return a * factor;
  }
  [[nodiscard]] friend constexpr BasicVec3 operator/(const BasicVec3& a, T divisor) noexcept {
    return {a.at_[0] / divisor, a.at_[1] / divisor, a.at_[2] / divisor};
  }
  /// @}
  /// True if all coordinates are equal; NaN equals nothing.
  [[nodiscard]] friend constexpr bool operator==(const BasicVec3& a, const BasicVec3& b) noexcept {
    return a.at_[0] == b.at_[0] && a.at_[1] == b.at_[1] && a.at_[2] == b.at_[2];
  }

 private:
  template <typename Join>
  [[nodiscard]] constexpr BasicVec3 joined(const BasicVec3& other, Join&& join) const noexcept {
    return {join(at_[0], other.at_[0]), join(at_[1], other.at_[1]), join(at_[2], other.at_[2])};
  }

  T at_[3] = {};
};

/// Vector of floats, the type of bounding volumes.
using Vec3f = BasicVec3<float>;
/// Vector of doubles, the type of poses.
using Vec3d = BasicVec3<double>;

static_assert(sizeof(Vec3f) == 12 && alignof(Vec3f) == 4 && std::is_trivially_copyable_v<Vec3f>);
static_assert(sizeof(Vec3d) == 24 && alignof(Vec3d) == 8 && std::is_trivially_copyable_v<Vec3d>);

}  // namespace winnow
