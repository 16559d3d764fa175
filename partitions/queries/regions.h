#pragma once

#include <winnow/core/regions.h>
#include <winnow/core/status.h>
#include "partitions/queries/region.kernel.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

namespace winnow {

/// A region prepared for the kernels. Not movable, because its parts point at each other.
class PreparedRegion {
 public:
  explicit PreparedRegion(const Region& region) noexcept;
  PreparedRegion(const PreparedRegion&) = delete;
  PreparedRegion& operator=(const PreparedRegion&) = delete;

  [[nodiscard]] Status status() const noexcept { return status_; }
  /// False if a sink is full and cannot grow.
  [[nodiscard]] bool run(const QueryView& view, const QueryFilter& filter,
                         RegionSinks& sinks) const;

 private:
  enum class RegionKind : std::uint8_t { planes, ball, capsule };

  Status prepare(const Vec3f& point) noexcept;
  Status prepare(const Aabb& box) noexcept;
  Status prepare(const OrientedBox& box) noexcept;
  Status prepare(const Sphere& sphere) noexcept;
  Status prepare(const Capsule& capsule) noexcept;
  Status prepare(const Frustum& frustum) noexcept;
  Status prepare(const std::span<const Plane>& planes) noexcept;
  void within(const Aabb& box) noexcept;
  void prune_by(const Eigen::Vector3d& normal, double offset, double size) noexcept;

  // If there are more planes, only the first kMaxPlanes prune; the test in double uses all.
  static constexpr std::size_t kMaxPlanes = 16;

  RegionKind kind_ = RegionKind::planes;
  Status status_;
  PlaneRegion planes_;
  BallRegion ball_;
  CapsuleRegion capsule_;
  std::span<const Plane> exact_planes_;
  std::array<WidePlane, kMaxPlanes> wide_;
};

}  // namespace winnow
