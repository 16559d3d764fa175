#pragma once

#include <winnow/core/export.h>

#include <cmath>
#include <concepts>
#include <type_traits>

namespace winnow {

template <typename T>
class BasicVec3;

namespace detail {

/// Three coordinates of type T read by x(), y() and z(): vectors and expressions of Eigen, and
/// those of users that are written alike.
template <typename Vector, typename T>
concept VectorLike = !std::derived_from<Vector, BasicVec3<T>> && requires(const Vector& v) {
  requires std::same_as<std::remove_cvref_t<decltype(v.x())>, T>;
  requires std::same_as<std::remove_cvref_t<decltype(v.y())>, T>;
  requires std::same_as<std::remove_cvref_t<decltype(v.z())>, T>;
};

/// A vector that Eigen stores, told by what it says of itself: its headers need not be read.
template <typename Vector, typename T>
concept EigenVector = requires {
  requires std::same_as<typename Vector::Scalar, T>;
  requires std::same_as<typename Vector::PlainObject, Vector>;
  requires Vector::SizeAtCompileTime == 3;
};

/// Of an expression of Eigen its value, computed once; anything else as it is.
template <typename Expression>
[[nodiscard]] constexpr decltype(auto) value_of(const Expression& expression) noexcept {
  if constexpr (requires { expression.eval(); }) {
    return expression.eval();
  } else {
    return (expression);
  }
}

}  // namespace detail

/// A point or a direction in space: three numbers one after another. Takes any vector whose
/// x(), y() and z() are of type T, as those of Eigen, and becomes a vector of Eigen where one is
/// asked for; <winnow/core/eigen.h> looks at it as one in place.
template <typename T>
class BasicVec3 {
  static_assert(std::is_floating_point_v<T>);

 public:
  /// The origin.
  constexpr BasicVec3() noexcept = default;
  /// From its coordinates.
  constexpr BasicVec3(T x, T y, T z) noexcept : at_{x, y, z} {}
  /// From three numbers one after another.
  explicit constexpr BasicVec3(const T* numbers) noexcept
      : at_{numbers[0], numbers[1], numbers[2]} {}
  /// From any other type of vectors.
  template <detail::VectorLike<T> Vector>
  constexpr BasicVec3(const Vector& other) noexcept {  // NOLINT(google-explicit-constructor)
    decltype(auto) v = detail::value_of(other);
    at_[0] = v.x();
    at_[1] = v.y();
    at_[2] = v.z();
  }
  /// To a vector of Eigen.
  template <detail::EigenVector<T> Vector>
  operator Vector() const noexcept {  // NOLINT(google-explicit-constructor)
    return Vector(at_[0], at_[1], at_[2]);
  }

  /// All three coordinates the same.
  [[nodiscard]] static constexpr BasicVec3 constant(T value) noexcept {
    return {value, value, value};
  }

  [[nodiscard]] constexpr T x() const noexcept { return at_[0]; }  ///< the first coordinate
  [[nodiscard]] constexpr T y() const noexcept { return at_[1]; }  ///< the second one
  [[nodiscard]] constexpr T z() const noexcept { return at_[2]; }  ///< the third one
  [[nodiscard]] constexpr T& x() noexcept { return at_[0]; }       ///< the first, to be set
  [[nodiscard]] constexpr T& y() noexcept { return at_[1]; }       ///< the second, to be set
  [[nodiscard]] constexpr T& z() noexcept { return at_[2]; }       ///< the third, to be set

  /// Coordinate `axis`, 0..2.
  template <std::integral Index>
  [[nodiscard]] constexpr T operator[](Index axis) const noexcept {
    return at_[axis];
  }
  /// The same, to be set.
  template <std::integral Index>
  [[nodiscard]] constexpr T& operator[](Index axis) noexcept {
    return at_[axis];
  }

  /// The three coordinates, contiguous.
  [[nodiscard]] constexpr const T* data() const noexcept { return at_; }
  /// The same, to be set.
  [[nodiscard]] constexpr T* data() noexcept { return at_; }

  /// Every coordinate converted to another type, rounded to the nearest.
  template <typename Other>
  [[nodiscard]] constexpr BasicVec3<Other> cast() const noexcept {
    return {static_cast<Other>(at_[0]), static_cast<Other>(at_[1]), static_cast<Other>(at_[2])};
  }

  /// True unless a coordinate is infinite or NaN.
  [[nodiscard]] constexpr bool all_finite() const noexcept {
    return at_[0] - at_[0] == T{0} && at_[1] - at_[1] == T{0} && at_[2] - at_[2] == T{0};
  }
  /// True if every coordinate is 0.
  [[nodiscard]] constexpr bool is_zero() const noexcept {
    return at_[0] == T{0} && at_[1] == T{0} && at_[2] == T{0};
  }

  /// The scalar product, summed in the order of the coordinates.
  [[nodiscard]] constexpr T dot(const BasicVec3& other) const noexcept {
    return at_[0] * other.at_[0] + at_[1] * other.at_[1] + at_[2] * other.at_[2];
  }
  /// The vector product.
  [[nodiscard]] constexpr BasicVec3 cross(const BasicVec3& other) const noexcept {
    return {at_[1] * other.at_[2] - at_[2] * other.at_[1],
            at_[2] * other.at_[0] - at_[0] * other.at_[2],
            at_[0] * other.at_[1] - at_[1] * other.at_[0]};
  }
  /// The square of its length.
  [[nodiscard]] constexpr T squared_norm() const noexcept { return dot(*this); }
  /// Its length.
  [[nodiscard]] T norm() const noexcept { return std::sqrt(squared_norm()); }

  /// The lesser of either coordinate; where one is NaN, this one's.
  [[nodiscard]] constexpr BasicVec3 min(const BasicVec3& other) const noexcept {
    return joined(other, [](T a, T b) { return b < a ? b : a; });
  }
  /// The greater of either coordinate; where one is NaN, this one's.
  [[nodiscard]] constexpr BasicVec3 max(const BasicVec3& other) const noexcept {
    return joined(other, [](T a, T b) { return a < b ? b : a; });
  }
  /// The absolute values of its coordinates.
  [[nodiscard]] constexpr BasicVec3 abs() const noexcept {
    return joined(*this, [](T a, T) { return a < T{0} ? -a : a + T{0}; });
  }

  /// Adds each coordinate of another to its own.
  constexpr BasicVec3& operator+=(const BasicVec3& other) noexcept { return *this = *this + other; }
  /// Subtracts each coordinate of another from its own.
  constexpr BasicVec3& operator-=(const BasicVec3& other) noexcept { return *this = *this - other; }
  /// Multiplies each coordinate.
  constexpr BasicVec3& operator*=(T factor) noexcept { return *this = *this * factor; }
  /// Divides each coordinate.
  constexpr BasicVec3& operator/=(T divisor) noexcept { return *this = *this / divisor; }

  /// The other way, as long.
  [[nodiscard]] friend constexpr BasicVec3 operator-(const BasicVec3& a) noexcept {
    return {-a.at_[0], -a.at_[1], -a.at_[2]};
  }
  /// The sums of the coordinates.
  [[nodiscard]] friend constexpr BasicVec3 operator+(const BasicVec3& a,
                                                     const BasicVec3& b) noexcept {
    return a.joined(b, [](T p, T q) { return p + q; });
  }
  /// The differences of the coordinates.
  [[nodiscard]] friend constexpr BasicVec3 operator-(const BasicVec3& a,
                                                     const BasicVec3& b) noexcept {
    return a.joined(b, [](T p, T q) { return p - q; });
  }
  /// Each coordinate times the factor.
  [[nodiscard]] friend constexpr BasicVec3 operator*(const BasicVec3& a, T factor) noexcept {
    return {a.at_[0] * factor, a.at_[1] * factor, a.at_[2] * factor};
  }
  /// The same.
  [[nodiscard]] friend constexpr BasicVec3 operator*(T factor, const BasicVec3& a) noexcept {
    return a * factor;
  }
  /// Each coordinate by the divisor.
  [[nodiscard]] friend constexpr BasicVec3 operator/(const BasicVec3& a, T divisor) noexcept {
    return {a.at_[0] / divisor, a.at_[1] / divisor, a.at_[2] / divisor};
  }
  /// True if all coordinates are equal; NaN is equal to nothing.
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

/// In float, as bounding volumes are.
using Vec3f = BasicVec3<float>;
/// In double, as poses are.
using Vec3d = BasicVec3<double>;

static_assert(sizeof(Vec3f) == 12 && alignof(Vec3f) == 4 && std::is_trivially_copyable_v<Vec3f>);
static_assert(sizeof(Vec3d) == 24 && alignof(Vec3d) == 8 && std::is_trivially_copyable_v<Vec3d>);

}  // namespace winnow
