#pragma once

// One-sided triangles: what stands behind one does not meet it.

#include <Eigen/Core>
#include <algorithm>

namespace winnow {

/// As a share of its size: what is no farther behind a plane stands in it.
inline constexpr double kBehindSlack = 1e-6;

/// True if the middle of a box lies behind a plane through `corner` with the normal `front`, of any
/// length. False for boxes without an end, which have no middle.
[[nodiscard]] inline bool is_behind(const Eigen::Vector3d& front, const Eigen::Vector3d& corner,
                                    const Eigen::Vector3d& min,
                                    const Eigen::Vector3d& max) noexcept {
  const double slack = kBehindSlack * (max - min).cwiseAbs().sum() * front.norm();
  return front.dot(0.5 * (min + max) - corner) < -slack;
}

}  // namespace winnow
