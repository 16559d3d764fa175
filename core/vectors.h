#pragma once

// Vectors and matrices of public headers: Vec3f, Vec3d, Mat3f, Mat3d, Mat4d. They convert from and
// to Eigen's types without including Eigen.

#include <winnow/core/export.h>

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace winnow {

// A host program may round in any direction and flush denormals (FTZ, DAZ). Library code switches
// to the default environment. Inline functions of headers run in the host's environment and must
// round outward there, too.

namespace detail {

inline constexpr std::uint32_t kSign = 0x80000000U;
inline constexpr std::uint32_t kExponent = 0x7F800000U;

/// Returns the smaller number. If the host treats denormals as 0 in comparisons, two numbers may
/// compare equal to 0; then their bits are compared as integers, which have the same order.
[[nodiscard]] constexpr float lesser(float a, float b) noexcept {
  const float found = b < a ? b : a;
  if (found != 0.0F) [[likely]]
    return found;
  const auto x = std::bit_cast<std::int32_t>(a);
  const auto y = std::bit_cast<std::int32_t>(b);
  const std::int32_t both_negative = (x & y) >> 31;
  return (y ^ both_negative) < (x ^ both_negative) ? b : a;
}

/// `round_up` for values below the smallest normal float in magnitude. Works in integers, which are
/// never flushed.
[[nodiscard]] constexpr float round_up_tiny(double value) noexcept {
  constexpr std::uint64_t kOne = std::uint64_t{1} << 52U;
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const std::uint64_t exponent = bits >> 52U & 0x7FFU;
  const std::uint64_t mantissa = (bits & (kOne - 1)) | (exponent == 0 ? 0 : kOne);
  // Converts to units of 2^-149, the smallest denormal float; smaller values shift to 0.
  const std::uint64_t shift = exponent < 863 ? 63 : 1023 + 52 - 149 - exponent;
  const std::uint64_t whole = mantissa >> shift;
  const bool is_negative = bits >> 63U != 0;
  const std::uint64_t units = whole + (!is_negative && whole << shift != mantissa ? 1 : 0);
  return std::bit_cast<float>(static_cast<std::uint32_t>(units) | (is_negative ? kSign : 0));
}

/// Returns `value` as a double, exactly. A plain conversion would flush denormals if the host does.
[[nodiscard]] constexpr double to_double(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  if ((bits & kExponent) != 0) [[likely]]
    return static_cast<double>(value);
  const double size = static_cast<double>(static_cast<std::int32_t>(bits & ~kSign)) * 0x1p-149;
  return (bits & kSign) != 0 ? -size : size;
}

/// Returns the next larger float after a finite or -infinite `value`. Works on the bits instead of
/// calling std::nextafter.
[[nodiscard]] constexpr float next_up(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  // Adds 1 to the bits, or subtracts 1 if negative. After 0 of either sign comes the smallest
  // denormal.
  const std::uint32_t next = bits + 1U - 2U * (bits >> 31U);
  return std::bit_cast<float>((bits & 0x7FFFFFFFU) == 0 ? 1U : next);
}

/// Returns the smallest float that is >= `value`. NaN stays NaN; above the float range the result
/// is +infinity.
[[nodiscard]] constexpr float round_up(double value) noexcept {
  const float nearest = static_cast<float>(value);
  const auto bits = std::bit_cast<std::uint32_t>(nearest);
  if ((bits & kExponent) == 0) [[unlikely]]
    return round_up_tiny(value);
  // Branchless: the direction is unpredictable.
  const std::uint32_t up = static_cast<double>(nearest) < value ? ~0U : 0U;
  const std::uint32_t above = (bits & kSign) != 0 ? bits - 1U : bits + 1U;
  return std::bit_cast<float>(bits ^ ((bits ^ above) & up));
}

/// Returns the largest float that is <= `value`. NaN stays NaN; below the float range the result is
/// -infinity.
[[nodiscard]] constexpr float round_down(double value) noexcept {
  return -round_up(-value);
}

/// Returns the float nearest to `value`, clamped to the finite floats. NaN stays NaN.
[[nodiscard]] constexpr float finite_float(double value) noexcept {
  constexpr auto kMaxFloat = static_cast<double>(std::numeric_limits<float>::max());
  return static_cast<float>(value < -kMaxFloat ? -kMaxFloat
                                               : (kMaxFloat < value ? kMaxFloat : value));
}

/// Returns the largest double that is <= the exact a + b, if the sum is finite. If the host flushes
/// denormals, this holds for 0 and for numbers of at least 2^-959, which includes all floats and
/// products of two floats.
[[nodiscard]] inline double add_down(double a, double b) noexcept {
  const bool swapped = std::abs(a) < std::abs(b);
  const double greater = swapped ? b : a;
  const double smaller = swapped ? a : b;
  const double sum = greater + smaller;
  // The part of `smaller` that is in the sum is sum - greater, a double in every rounding direction
  // (Boldo, Graillat and Muller, "On the robustness of the 2Sum and Fast2Sum algorithms", ACM TOMS
  // 44(1), 2017). A sum of 0 has no error.
  const bool above = smaller < sum - greater;
  // Subtracts 1 from the bits, or adds 1 if the sum is negative; branchless, as in `round_up`.
  const auto bits = std::bit_cast<std::int64_t>(sum);
  return std::bit_cast<double>(bits - (above ? (bits >> 63) | 1 : 0));
}

/// Returns the smallest double that is >= the exact a + b, under the conditions of `add_down`.
[[nodiscard]] inline double add_up(double a, double b) noexcept {
  return -add_down(-a, -b);
}

}  // namespace detail

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

namespace detail {

/// Applies `round_down` to each coordinate.
[[nodiscard]] inline Vec3f round_down(const Vec3d& v) noexcept {
  return {round_down(v.x()), round_down(v.y()), round_down(v.z())};
}

/// Applies `round_up` to each coordinate.
[[nodiscard]] inline Vec3f round_up(const Vec3d& v) noexcept {
  return {round_up(v.x()), round_up(v.y()), round_up(v.z())};
}

}  // namespace detail

template <typename T, int N>
class BasicMatrix;

namespace detail {

/// A matrix type other than BasicMatrix with an operator()(row, column) that returns a T, such as a
/// matrix or expression of Eigen, or a user type. If the size of the type is known at compile time,
/// it must be N x N.
template <typename Matrix, typename T, int N>
concept MatrixLike = !std::derived_from<Matrix, BasicMatrix<T, N>> && requires(const Matrix& m) {
  requires std::same_as<std::remove_cvref_t<decltype(m(0, 0))>, T>;
}
&&!requires {
  requires Matrix::RowsAtCompileTime != N || Matrix::ColsAtCompileTime != N;
};

/// An Eigen matrix that stores its elements; see EigenVector.
template <typename Matrix, typename T, int N>
concept EigenMatrix = requires {
  requires std::same_as<typename Matrix::Scalar, T>;
  requires std::same_as<typename Matrix::PlainObject, Matrix>;
  requires Matrix::RowsAtCompileTime == N&& Matrix::ColsAtCompileTime == N;
};

}  // namespace detail

/// N x N matrix, stored column by column. Any matrix with an operator()(row, column) that returns a
/// T, such as Eigen's, converts to it, and it converts to Eigen matrices.
template <typename T, int N>
class BasicMatrix {
 public:
  /// Creates a matrix of zeros.
  constexpr BasicMatrix() noexcept = default;
  /// Creates a matrix from its elements, row by row.
  template <std::convertible_to<T>... Rest>
  requires(sizeof...(Rest) == N * N - 1) constexpr BasicMatrix(T first, Rest... rest) noexcept {
    const T rows[N * N] = {first, static_cast<T>(rest)...};
    fill([&](int row, int column) { return rows[row * N + column]; });
  }
  /// Converts a matrix of another type.
  template <detail::MatrixLike<T, N> Matrix>
  constexpr BasicMatrix(const Matrix& other) noexcept {  // NOLINT(google-explicit-constructor)
    decltype(auto) m = detail::value_of(other);
    fill([&](int row, int column) { return m(row, column); });
  }
  /// Converts to an Eigen matrix.
  template <detail::EigenMatrix<T, N> Matrix>
  operator Matrix() const noexcept {  // NOLINT(google-explicit-constructor)
    Matrix result;
    for (int column = 0; column < N; ++column) {
      for (int row = 0; row < N; ++row) result(row, column) = (*this)(row, column);
    }
    return result;
  }

  /// Returns the identity matrix.
  [[nodiscard]] static constexpr BasicMatrix identity() noexcept {
    BasicMatrix result;
    result.fill([](int row, int column) { return row == column ? T{1} : T{0}; });
    return result;
  }

  /// Element in a row and a column, both 0..N - 1.
  template <std::integral Index>
  [[nodiscard]] constexpr T operator()(Index row,
                                       std::type_identity_t<Index> column) const noexcept {
    return at_[column][row];
  }
  /// Writable element in a row and a column, both 0..N - 1.
  template <std::integral Index>
  [[nodiscard]] constexpr T& operator()(Index row, std::type_identity_t<Index> column) noexcept {
    return at_[column][row];
  }

  /// Returns column `i` of a 3 x 3 matrix.
  [[nodiscard]] constexpr BasicVec3<T> column(int i) const noexcept requires(N == 3) {
    return {at_[i][0], at_[i][1], at_[i][2]};
  }
  /// Sets column `i` of a 3 x 3 matrix.
  constexpr void set_column(int i, const BasicVec3<T>& v) noexcept requires(N == 3) {
    for (int row = 0; row < 3; ++row) at_[i][row] = v[row];
  }

  /// Returns the matrix with each element converted to another type, rounded to nearest.
  template <typename Other>
  [[nodiscard]] constexpr BasicMatrix<Other, N> cast() const noexcept {
    BasicMatrix<Other, N> result;
    for (int column = 0; column < N; ++column) {
      for (int row = 0; row < N; ++row) {
        result(row, column) = static_cast<Other>((*this)(row, column));
      }
    }
    return result;
  }

  /// Returns true if no element is infinite or NaN.
  [[nodiscard]] constexpr bool all_finite() const noexcept {
    for (const auto& column : at_) {
      for (const T number : column) {
        if (!(number - number == T{0})) return false;
      }
    }
    return true;
  }

  /// Returns a pointer to the elements, column by column.
  [[nodiscard]] constexpr const T* data() const noexcept { return at_[0]; }
  /// Returns a writable pointer to the elements, column by column.
  [[nodiscard]] constexpr T* data() noexcept { return at_[0]; }

  /// True if all elements are equal; NaN equals nothing.
  [[nodiscard]] friend constexpr bool operator==(const BasicMatrix&,
                                                 const BasicMatrix&) noexcept = default;

 private:
  template <typename NumberAt>
  constexpr void fill(NumberAt&& number_at) noexcept {
    for (int column = 0; column < N; ++column) {
      for (int row = 0; row < N; ++row) at_[column][row] = number_at(row, column);
    }
  }

  T at_[N][N] = {};
};

/// 3 x 3 matrix of floats.
using Mat3f = BasicMatrix<float, 3>;
/// 3 x 3 matrix of doubles.
using Mat3d = BasicMatrix<double, 3>;
/// 4 x 4 matrix of doubles.
using Mat4d = BasicMatrix<double, 4>;

static_assert(sizeof(Mat3f) == 36 && alignof(Mat3f) == 4 && std::is_trivially_copyable_v<Mat3f>);

}  // namespace winnow
