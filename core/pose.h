#pragma once

#include <winnow/core/export.h>
#include <winnow/core/quaternion.h>
#include <winnow/core/vec3.h>

namespace winnow {

/// Position and orientation of a body: maps x to position + orientation * x. Position and
/// orientation are in double, so that poses from a file or a solver are used unchanged. The narrow
/// phase computes with differences of positions, so its accuracy does not depend on the distance
/// from the world's origin.
struct Pose {
  Vec3d position{};          ///< of the shape's origin, in world coordinates
  Quaternion orientation{};  ///< of any finite length except zero

  /// Returns a pose at a position, without rotation.
  /// @{
  [[nodiscard]] static constexpr Pose at(const Vec3d& position) noexcept { return {position, {}}; }
  [[nodiscard]] static constexpr Pose at(double x, double y, double z) noexcept {
    return {{x, y, z}, {}};
  }
  /// @}

  /// Returns true if all numbers are finite and the quaternion is not zero.
  [[nodiscard]] bool is_valid() const noexcept {
    double sum = 0.0;
    double turn = 0.0;
    for (const double q : orientation) {
      sum += q - q;
      turn = turn > q ? turn : q;
      turn = turn > -q ? turn : -q;
    }
    return position.all_finite() && sum == 0.0 && turn > 0.0;
  }

  /// Returns the pose that maps a point back.
  [[nodiscard]] Pose inverse() const noexcept {
    const Quaternion back = orientation.inverse();
    return {-(back * position), back};
  }
  /// Maps a point from the frame of the body to the world.
  [[nodiscard]] Vec3d operator*(const Vec3d& point) const noexcept {
    return position + orientation * point;
  }
  /// Returns the pose in the world of something whose pose is relative to this body.
  [[nodiscard]] Pose operator*(const Pose& inner) const noexcept {
    return {*this * inner.position, orientation * inner.orientation};
  }
  /// True if all numbers are equal.
  friend constexpr bool operator==(const Pose&, const Pose&) noexcept = default;
};

static_assert(sizeof(Pose) == 56 && alignof(Pose) == 8, "layout must not depend on build flags");

}  // namespace winnow
