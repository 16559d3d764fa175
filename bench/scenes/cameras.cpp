#include "bench/scenes/cameras.h"

#include <winnow/core/eigen.h>
#include "bench/scenes/random_shapes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace winnow::bench {
namespace {

constexpr float kFieldOfView = 1.0471976F;
constexpr float kAspect = 1.6F;

/// Returns whether the box intersects the frustum's bounds and is not entirely behind one of its
/// planes.
bool sees(const Frustum& camera, const Aabb& box) noexcept {
  if (!camera.bounds.overlaps(box)) return false;
  for (const Plane& plane : camera.planes) {
    const Eigen::Vector3f corner =
        (as_eigen(plane.normal).array() > 0.0F).select(as_eigen(box.max), as_eigen(box.min));
    if (plane.normal.dot(corner) + plane.offset < 0.0F) return false;
  }
  return true;
}

/// Returns the share of boxes that are visible, estimated from about 2,000 of them.
double share_seen(const Frustum& camera, std::span<const Aabb> boxes) noexcept {
  const std::size_t step = std::max<std::size_t>(1, boxes.size() / 2000);
  std::size_t seen = 0;
  std::size_t sampled = 0;
  for (std::size_t i = 0; i < boxes.size(); i += step, ++sampled) seen += sees(camera, boxes[i]);
  return sampled == 0 ? 0.0 : static_cast<double>(seen) / static_cast<double>(sampled);
}

}  // namespace

Aabb world_of(std::span<const Aabb> boxes) noexcept {
  Aabb world;
  for (const Aabb& box : boxes) {
    if (box.min.all_finite() && box.max.all_finite()) world.merge(box);
  }
  if (!world.is_valid()) world = {Eigen::Vector3f::Zero(), Eigen::Vector3f::Ones()};
  return world;
}

Frustum camera_that_sees(double share, std::span<const Aabb> boxes, const Aabb& world,
                         Random& random) {
  const Eigen::Vector3f center = 0.5F * (world.min + world.max);
  const Eigen::Vector3f half = 0.5F * (world.max - world.min);
  const float diagonal = 2.0F * half.norm();
  Frustum camera;
  // A camera at the border that looks outward cannot see enough boxes, so another one is drawn.
  for (int attempt = 0; attempt < 20; ++attempt) {
    const Eigen::Vector3f forward = random_unit(random).cast<float>();
    const Eigen::Vector3f up = random_unit(random).cast<float>();
    Eigen::Vector3f eye = center - 0.7F * diagonal * forward;
    if (share < 0.1) {
      for (int axis = 0; axis < 3; ++axis) {
        eye[axis] = center[axis] + half[axis] * static_cast<float>(random.in(-1.0, 1.0));
      }
    }
    const float near_t = 1e-3F * diagonal;
    float low = 2.0F * near_t;
    float high = 2.0F * diagonal;
    const auto camera_to = [&](float far_t) {
      return Frustum::perspective(eye, forward, up, kFieldOfView, kAspect, near_t, far_t);
    };
    if (share_seen(camera_to(high), boxes) < share) continue;
    for (int step = 0; step < 16; ++step) {
      const float middle = 0.5F * (low + high);
      (share_seen(camera_to(middle), boxes) < share ? low : high) = middle;
    }
    camera = camera_to(high);
    if (camera.is_valid()) return camera;
  }
  return Frustum::perspective(center - 0.7F * diagonal * Eigen::Vector3f::UnitX(),
                              Eigen::Vector3f::UnitX(), Eigen::Vector3f::UnitZ(), kFieldOfView,
                              kAspect, 1e-3F * diagonal, 2.0F * diagonal);
}

}  // namespace winnow::bench
