#pragma once

// The only public header that includes Eigen, for programs that compute with Eigen. Others do not
// need it: winnow's vectors and matrices convert from and to Eigen types without it.

#include <winnow/core/vectors.h>

#include <Eigen/Core>

namespace winnow {

/// Returns a read-only Eigen map of the vector, which must outlive the map.
template <typename T>
[[nodiscard]] Eigen::Map<const Eigen::Matrix<T, 3, 1>> as_eigen(const BasicVec3<T>& v) noexcept {
  return Eigen::Map<const Eigen::Matrix<T, 3, 1>>(v.data());
}
/// Returns a writable Eigen map of the vector, which must outlive the map.
template <typename T>
[[nodiscard]] Eigen::Map<Eigen::Matrix<T, 3, 1>> as_eigen(BasicVec3<T>& v) noexcept {
  return Eigen::Map<Eigen::Matrix<T, 3, 1>>(v.data());
}

/// Returns a read-only Eigen map of the matrix, which must outlive the map.
template <typename T, int N>
[[nodiscard]] Eigen::Map<const Eigen::Matrix<T, N, N>> as_eigen(
    const BasicMatrix<T, N>& m) noexcept {
  return Eigen::Map<const Eigen::Matrix<T, N, N>>(m.data());
}
/// Returns a writable Eigen map of the matrix, which must outlive the map.
template <typename T, int N>
[[nodiscard]] Eigen::Map<Eigen::Matrix<T, N, N>> as_eigen(BasicMatrix<T, N>& m) noexcept {
  return Eigen::Map<Eigen::Matrix<T, N, N>>(m.data());
}

}  // namespace winnow
