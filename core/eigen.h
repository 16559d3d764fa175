#pragma once

// The one public header that reads Eigen, for who computes with it: nothing else needs it, since
// winnow's vectors and matrices take those of Eigen, and turn into them, by themselves.

#include <winnow/core/matrix.h>
#include <winnow/core/vec3.h>

#include <Eigen/Core>

namespace winnow {

/// A vector looked at in place as one of Eigen, to be read; it must outlive what this returns.
template <typename T>
[[nodiscard]] Eigen::Map<const Eigen::Matrix<T, 3, 1>> as_eigen(const BasicVec3<T>& v) noexcept {
  return Eigen::Map<const Eigen::Matrix<T, 3, 1>>(v.data());
}
/// The same, to be set.
template <typename T>
[[nodiscard]] Eigen::Map<Eigen::Matrix<T, 3, 1>> as_eigen(BasicVec3<T>& v) noexcept {
  return Eigen::Map<Eigen::Matrix<T, 3, 1>>(v.data());
}

/// A matrix looked at in place as one of Eigen, to be read; it must outlive what this returns.
template <typename T, int N>
[[nodiscard]] Eigen::Map<const Eigen::Matrix<T, N, N>> as_eigen(
    const BasicMatrix<T, N>& m) noexcept {
  return Eigen::Map<const Eigen::Matrix<T, N, N>>(m.data());
}
/// The same, to be set.
template <typename T, int N>
[[nodiscard]] Eigen::Map<Eigen::Matrix<T, N, N>> as_eigen(BasicMatrix<T, N>& m) noexcept {
  return Eigen::Map<Eigen::Matrix<T, N, N>>(m.data());
}

}  // namespace winnow
