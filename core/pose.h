#pragma once

// Positions and orientations of bodies. Quaternion converts from and to Eigen's quaternions without
// including Eigen.

#include <winnow/core/export.h>
#include <winnow/core/point_view.h>
#include <winnow/core/vectors.h>

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <span>
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
  /// Returns a quaternion of length 1, up to rounding, with the same rotation.
  [[nodiscard]] Quaternion normalized() const noexcept;
  /// Returns the rotation matrix. Exact for the identity and for half and quarter turns about the
  /// axes.
  [[nodiscard]] Mat3d matrix() const noexcept;
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

namespace detail {

/// Returns the orientation of a valid pose divided by its largest component, so that products of
/// two components stay in the range of double. Exact for the identity.
[[nodiscard]] inline Quaternion scale_to_unit_max(const Quaternion& orientation) noexcept {
  double largest = 0.0;
  for (const double q : orientation) largest = std::fabs(q) > largest ? std::fabs(q) : largest;
  return {orientation[0] / largest, orientation[1] / largest, orientation[2] / largest,
          orientation[3] / largest};
}

/// Returns the rotation matrix of `q`; `scale` must be 2 / |q|^2.
[[nodiscard]] inline Mat3d scaled_rotation(const Quaternion& q, double scale) noexcept {
  const double w = q.w();
  const double x = q.x();
  const double y = q.y();
  const double z = q.z();
  return {
      1.0 - scale * (y * y + z * z), scale * (x * y - w * z),       scale * (x * z + w * y),  //
      scale * (x * y + w * z),       1.0 - scale * (x * x + z * z), scale * (y * z - w * x),  //
      scale * (x * z - w * y),       scale * (y * z + w * x),       1.0 - scale * (x * x + y * y)};
}

[[nodiscard]] inline double squared_length(const Quaternion& q) noexcept {
  return (q[0] * q[0] + q[2] * q[2]) + (q[1] * q[1] + q[3] * q[3]);
}

}  // namespace detail

inline Vec3d Quaternion::operator*(const Vec3d& v) const noexcept {
  const Quaternion q = detail::scale_to_unit_max(*this);
  const Vec3d axis{q.x(), q.y(), q.z()};
  const Vec3d across = axis.cross(v);
  const double scale = 2.0 / (q.w() * q.w() + axis.squared_norm());
  return v + (q.w() * across + axis.cross(across)) * scale;
}

inline Quaternion Quaternion::normalized() const noexcept {
  const Quaternion q = detail::scale_to_unit_max(*this);
  const double length = std::sqrt(detail::squared_length(q));
  return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

inline Mat3d Quaternion::matrix() const noexcept {
  const Quaternion q = detail::scale_to_unit_max(*this);
  return detail::scaled_rotation(q, 2.0 / detail::squared_length(q));
}

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

/// Non-owning view of poses in the caller's memory: pointers to the three coordinates of positions
/// (double) and to the four of orientations (w, x, y, z; double or float), and the distances in
/// bytes from one pose to the next. It copies nothing and must not outlive that memory. If the view
/// has no orientations, calls that move bodies keep their orientations, and `operator[]` returns
/// poses without rotation.
struct PoseView {
  std::array<const double*, 3> position{};  ///< of the first pose: x, y, z
  /// Bytes from one position to the next.
  std::size_t position_stride = sizeof(double);
  std::array<const double*, 4> orientation{};  ///< of the first pose: w, x, y, z
  /// The orientations in float, used if `orientation` is null.
  std::array<const float*, 4> orientation_float{};
  /// Bytes from one orientation to the next.
  std::size_t orientation_stride = sizeof(double);
  std::size_t count = 0;  ///< number of poses

  PoseView() = default;

  /// Views any contiguous container of poses.
  template <std::convertible_to<std::span<const Pose>> Poses>
  PoseView(const Poses& container) noexcept {  // NOLINT(google-explicit-constructor)
    const std::span<const Pose> poses = container;
    if (poses.empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis)
      position[axis] = poses.data()->position.data() + axis;
    for (std::size_t k = 0; k < 4; ++k) orientation[k] = poses.data()->orientation.data() + k;
    position_stride = orientation_stride = sizeof(Pose);
    count = poses.size();
  }

  /// Views positions without orientations.
  PoseView(std::array<const double*, 3> positions, std::size_t poses,
           std::size_t position_bytes = sizeof(double)) noexcept
      : position(positions), position_stride(position_bytes), count(poses) {}
  /// Views an array of positions, which are vectors in double, without orientations; see PointView.
  template <detail::ArrayOfPoints Points>
  [[nodiscard]] static PoseView of_positions(const Points& positions) noexcept {
    static_assert(detail::PointsOf<Points, double>, "positions of bodies are in double");
    const PointView points(positions);
    return {points.precise, points.count, points.stride};
  }

  /// Views columns, or members of any struct.
  PoseView(std::array<const double*, 3> positions, std::array<const float*, 4> orientations,
           std::size_t poses, std::size_t position_bytes = sizeof(double),
           std::size_t orientation_bytes = sizeof(float)) noexcept
      : position(positions),
        position_stride(position_bytes),
        orientation_float(orientations),
        orientation_stride(orientation_bytes),
        count(poses) {}
  /// As above, with orientations in double.
  PoseView(std::array<const double*, 3> positions, std::array<const double*, 4> orientations,
           std::size_t poses, std::size_t position_bytes = sizeof(double),
           std::size_t orientation_bytes = sizeof(double)) noexcept
      : position(positions),
        position_stride(position_bytes),
        orientation(orientations),
        orientation_stride(orientation_bytes),
        count(poses) {}

  /// Returns true if the view has orientations.
  [[nodiscard]] bool has_orientations() const noexcept {
    return orientation[0] != nullptr || orientation_float[0] != nullptr;
  }
  /// Returns a copy of pose i; i must be below `count`.
  [[nodiscard]] Pose operator[](std::size_t i) const noexcept {
    Pose pose;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      pose.position[axis] = detail::strided(position[axis], i, position_stride);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      if (orientation[k] != nullptr) {
        pose.orientation[k] = detail::strided(orientation[k], i, orientation_stride);
      } else if (orientation_float[k] != nullptr) {
        pose.orientation[k] =
            static_cast<double>(detail::strided(orientation_float[k], i, orientation_stride));
      }
    }
    return pose;
  }
};

}  // namespace winnow
