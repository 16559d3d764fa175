#include <winnow/core/eigen.h>
#include <winnow/core/regions.h>
#include "core/threads/float_environment.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace winnow {
namespace {

using Corners = std::array<Eigen::Vector3d, 8>;

/// Returns a frustum for which `is_valid` is false.
Frustum invalid() noexcept {
  Frustum frustum;
  for (Plane& plane : frustum.planes) plane = {{0.0F, 0.0F, 0.0F}, 0.0F};
  return frustum;
}

/// Returns a plane in float. Normalizes it in double, so that a tiny or huge normal fits in float.
Plane inward(const Eigen::Vector3d& normal, double offset) noexcept {
  const double length = normal.norm();
  const double scale = length > 0.0 ? 1.0 / length : 1.0;
  return {(normal * scale).cast<float>(), static_cast<float>(offset * scale)};
}

/// Returns the bounding box of the corners, enlarged by 1e-7 of the largest coordinate for the
/// rounding error of the corners. If a corner is not finite, the box is infinite.
Aabb around(const Corners& corners) noexcept {
  Eigen::Vector3d low = corners[0];
  Eigen::Vector3d high = corners[0];
  for (const Eigen::Vector3d& corner : corners) {
    if (!corner.allFinite()) return Frustum{}.bounds;
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const double slack = 1e-7 * std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  return Aabb::outward(low.array() - slack, high.array() + slack);
}

}  // namespace

Frustum Frustum::perspective(const Vec3f& eye, const Vec3f& forward, const Vec3f& up,
                             float vertical_fov, float aspect, float near_t, float far_t) noexcept {
  const DefaultFloatEnvironment environment;
  const Eigen::Vector3d f = as_eigen(forward).cast<double>().normalized();
  const Eigen::Vector3d r = f.cross(as_eigen(up).cast<double>()).normalized();
  const Eigen::Vector3d u = r.cross(f);
  const bool sound = eye.all_finite() && f.allFinite() && r.allFinite() && r.norm() > 0.5 &&
                     vertical_fov > 0.0F && vertical_fov < std::numbers::pi_v<float> &&
                     aspect > 0.0F && std::isfinite(aspect) && near_t >= 0.0F && near_t < far_t &&
                     std::isfinite(far_t);
  if (!sound) return invalid();
  const Eigen::Vector3d e = eye.cast<double>();
  const auto n = static_cast<double>(near_t);
  const auto d = static_cast<double>(far_t);
  const double y = std::tan(0.5 * static_cast<double>(vertical_fov));
  const double x = y * static_cast<double>(aspect);

  Frustum frustum;
  const std::array<Eigen::Vector3d, 4> sides{f * x + r, f * x - r, f * y + u, f * y - u};
  for (std::size_t i = 0; i < 4; ++i) frustum.planes[i] = inward(sides[i], -sides[i].dot(e));
  frustum.planes[4] = inward(f, -f.dot(e) - n);
  frustum.planes[5] = inward(-f, f.dot(e) + d);
  Corners corners;
  for (std::size_t i = 0; i < 8; ++i) {
    const double depth = (i & 4U) != 0 ? d : n;
    const double side = (i & 1U) != 0 ? x : -x;
    const double rise = (i & 2U) != 0 ? y : -y;
    corners[i] = e + depth * (f + side * r + rise * u);
  }
  frustum.bounds = around(corners);
  return frustum;
}

Frustum Frustum::from_matrix(const Mat4d& clip_from_world, NearDepth near_depth) noexcept {
  const DefaultFloatEnvironment environment;
  const Eigen::Matrix4d m = clip_from_world;
  if (!m.allFinite()) return invalid();
  const bool from_zero = near_depth == NearDepth::zero;
  const Eigen::Vector4d x = m.row(0);
  const Eigen::Vector4d y = m.row(1);
  const Eigen::Vector4d z = m.row(2);
  const Eigen::Vector4d w = m.row(3);
  const std::array<Eigen::Vector4d, 6> rows{w + x, w - x, w + y, w - y, from_zero ? z : w + z,
                                            w - z};
  Frustum frustum;
  for (std::size_t i = 0; i < 6; ++i) {
    frustum.planes[i] = inward(rows[i].head<3>(), rows[i].w());
  }
  // A depth plane at infinity has no valid normal and bounds nothing: the other depth plane
  // replaces it. With a reversed depth range, planes[4] is the far plane and may be at infinity.
  if (!frustum.planes[5].is_valid()) frustum.planes[5] = frustum.planes[4];
  if (!frustum.planes[4].is_valid()) frustum.planes[4] = frustum.planes[5];

  const Eigen::FullPivLU<Eigen::Matrix4d> inverse(m);
  if (!inverse.isInvertible()) return frustum;
  Corners corners;
  for (std::size_t i = 0; i < 8; ++i) {
    const Eigen::Vector4d clip((i & 1U) != 0 ? 1.0 : -1.0, (i & 2U) != 0 ? 1.0 : -1.0,
                               (i & 4U) != 0 ? 1.0 : (from_zero ? 0.0 : -1.0), 1.0);
    const Eigen::Vector4d p = inverse.solve(clip);
    // The corner is behind the eye or at infinity: the frustum has no finite bounding box.
    if (!(p.w() > 1e-12 * p.cwiseAbs().maxCoeff())) return frustum;
    corners[i] = p.head<3>() / p.w();
  }
  frustum.bounds = around(corners);
  return frustum;
}

bool Frustum::is_valid() const noexcept {
  const DefaultFloatEnvironment environment;
  return bounds.is_valid() &&
         std::all_of(planes.begin(), planes.end(), [](const Plane& p) { return p.is_valid(); });
}

}  // namespace winnow
