#pragma once

#include <winnow/core/vec3.h>

#include <concepts>
#include <type_traits>

namespace winnow {

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
