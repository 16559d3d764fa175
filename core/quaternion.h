#pragma once

// Quaternion, the orientation of a Pose. It converts from and to Eigen's quaternions without
// including Eigen.

#include <winnow/core/export.h>
#include <winnow/core/vec3.h>

#include <array>
#include <cmath>
#include <concepts>
#include <type_traits>

namespace winnow {

class Quaternion;

namespace detail {

/// A quaternion type with w(), x(), y() and z(), such as Eigen::Quaterniond.
template <typename Other>
concept QuaternionLike = !std::same_as<Other, Quaternion> && requires(const Other& q) {
  { q.w() } -> FitsIn<double>;
  { q.x() } -> FitsIn<double>;
  { q.y() } -> FitsIn<double>;
  { q.z() } -> FitsIn<double>;
};

/// An Eigen quaternion of doubles. It is recognised by its members, without Eigen's headers.
template <typename Other>
concept EigenQuaternion = requires {
  requires std::same_as<typename Other::Scalar, double>;
  typename Other::AngleAxisType;
  typename Other::Coefficients;
};

}  // namespace detail

/// A rotation: w + x i + y j + z k, of any finite length except zero. Its length does not matter:
/// each function uses the rotation of the normalised quaternion.
class Quaternion {
 public:
  /// Creates the identity.
  constexpr Quaternion() noexcept = default;
  /// Creates a quaternion from its coordinates, the real one first.
  constexpr Quaternion(double w, double x, double y, double z) noexcept : at_{w, x, y, z} {}
  /// Converts four numbers, the real one first.
  /// @{
  constexpr Quaternion(const double (&q)[4]) noexcept  // NOLINT(google-explicit-constructor)
      : at_{q[0], q[1], q[2], q[3]} {}
  constexpr Quaternion(  // NOLINT(google-explicit-constructor)
      const std::array<double, 4>& q) noexcept
      : at_{q[0], q[1], q[2], q[3]} {}
  /// @}
  /// Converts a quaternion of another type.
  template <detail::QuaternionLike Other>
  constexpr Quaternion(const Other& q) noexcept  // NOLINT(google-explicit-constructor)
      : at_{q.w(), q.x(), q.y(), q.z()} {}
  /// Converts to an Eigen quaternion.
  template <detail::EigenQuaternion Other>
  operator Other() const noexcept {  // NOLINT(google-explicit-constructor)
    return Other(at_[0], at_[1], at_[2], at_[3]);
  }

  /// Returns the rotation about an axis, of any finite length except zero, by an angle in radians.
  [[nodiscard]] static Quaternion about(const Vec3d& axis, double angle) noexcept {
    const double share = std::sin(0.5 * angle) / axis.norm();
    return {std::cos(0.5 * angle), axis.x() * share, axis.y() * share, axis.z() * share};
  }

  [[nodiscard]] constexpr double w() const noexcept { return at_[0]; }  ///< real coordinate
  [[nodiscard]] constexpr double x() const noexcept { return at_[1]; }  ///< of i
  [[nodiscard]] constexpr double y() const noexcept { return at_[2]; }  ///< of j
  [[nodiscard]] constexpr double z() const noexcept { return at_[3]; }  ///< of k

  /// Coordinate `i`, 0..3: w, x, y, z.
  template <std::integral Index>
  [[nodiscard]] constexpr double operator[](Index i) const noexcept {
    return at_[i];
  }
  /// Writable coordinate `i`, 0..3.
  template <std::integral Index>
  [[nodiscard]] constexpr double& operator[](Index i) noexcept {
    return at_[i];
  }
  /// Iterators over w, x, y and z, which are contiguous.
  /// @{
  [[nodiscard]] constexpr const double* data() const noexcept { return at_; }
  [[nodiscard]] constexpr double* data() noexcept { return at_; }
  [[nodiscard]] constexpr double* begin() noexcept { return at_; }
  [[nodiscard]] constexpr double* end() noexcept { return at_ + 4; }
  [[nodiscard]] constexpr const double* begin() const noexcept { return at_; }
  [[nodiscard]] constexpr const double* end() const noexcept { return at_ + 4; }
  /// @}

  /// Returns the opposite rotation.
  [[nodiscard]] constexpr Quaternion inverse() const noexcept {
    return {at_[0], -at_[1], -at_[2], -at_[3]};
  }
  /// Returns the rotated vector.
  [[nodiscard]] Vec3d operator*(const Vec3d& v) const noexcept;
  /// Returns the rotation that applies `inner` first, then this one. The length of the result is
  /// the product of the lengths.
  [[nodiscard]] constexpr Quaternion operator*(const Quaternion& inner) const noexcept {
    const double w = at_[0];
    const double x = at_[1];
    const double y = at_[2];
    const double z = at_[3];
    return {w * inner[0] - x * inner[1] - y * inner[2] - z * inner[3],
            w * inner[1] + x * inner[0] + y * inner[3] - z * inner[2],
            w * inner[2] - x * inner[3] + y * inner[0] + z * inner[1],
            w * inner[3] + x * inner[2] - y * inner[1] + z * inner[0]};
  }
  /// True if all coordinates are equal; two different quaternions may be one rotation.
  friend constexpr bool operator==(const Quaternion&, const Quaternion&) noexcept = default;

 private:
  double at_[4] = {1.0, 0.0, 0.0, 0.0};
};

static_assert(sizeof(Quaternion) == 32 && std::is_trivially_copyable_v<Quaternion>);

/// Returns the orientation of a valid pose divided by its largest component, so that products of
/// two components stay in the range of double. Exact for the identity.
[[nodiscard]] inline Quaternion scale_to_unit_max(const Quaternion& orientation) noexcept {
  double largest = 0.0;
  for (const double q : orientation) largest = std::fabs(q) > largest ? std::fabs(q) : largest;
  return {orientation[0] / largest, orientation[1] / largest, orientation[2] / largest,
          orientation[3] / largest};
}

inline Vec3d Quaternion::operator*(const Vec3d& v) const noexcept {
  const Quaternion q = scale_to_unit_max(*this);
  const Vec3d axis{q.x(), q.y(), q.z()};
  const Vec3d across = axis.cross(v);
  const double scale = 2.0 / (q.w() * q.w() + axis.squared_norm());
  return v + (q.w() * across + axis.cross(across)) * scale;
}

}  // namespace winnow
