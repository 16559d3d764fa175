#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace winnow {

/// A sample of a scene's bodies, from which the origin of its boxes is chosen.
///
/// Boxes are floats: at 1e8 floats are 8 apart, and the boxes of unit spheres there would all
/// overlap. Boxes that are measured from a point among the bodies, rounded outward from double, are
/// as tight as near (0, 0, 0).
class BodySample {
 public:
  static constexpr std::size_t kMaxSamples = 32;

  /// Adds a body with its bounding radius. Bodies of infinite radius are ignored.
  void add(const double position[3], double radius) noexcept;
  [[nodiscard]] bool is_full() const noexcept { return count_ == kMaxSamples; }

  /// Returns the origin for boxes. This is `current`, unless the median of the body positions is so
  /// far from it that (1) the float spacing there exceeds 2^-10 of the median radius, and (2) the
  /// distance is more than eight times the spread of the bodies, so that the new origin is much
  /// better. The new origin is the median on each axis, rounded to a multiple of a power of two
  /// about as large as the spread: differences to it are then mostly exact.
  [[nodiscard]] Eigen::Vector3d origin(const Eigen::Vector3d& current) const noexcept;

 private:
  std::array<std::array<double, kMaxSamples>, 3> position_;
  std::array<double, kMaxSamples> radius_;
  std::size_t count_ = 0;
};

}  // namespace winnow
