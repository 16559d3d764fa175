#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace winnow {

/// Some bodies of a scene, which tell where it stands.
///
/// Boxes are floats: at 1e8 they are 8 apart, and unit spheres there would have boxes that all
/// overlap. Measured from a point among the bodies, rounded outward from double, boxes are as tight
/// as at (0, 0, 0).
class ScenePlaces {
 public:
  static constexpr std::size_t kMost = 32;

  /// A body within a radius about a position. Those that reach to infinity tell nothing.
  void add(const double position[3], double radius) noexcept;
  [[nodiscard]] bool is_full() const noexcept { return count_ == kMost; }

  /// Where boxes are to be measured from: `current`, unless the middle of the bodies lies so far
  /// from there that a float's step is 2^-10 of their radius, and eight times as far as most of
  /// them lie from their middle, so that another point helps. The median of each axis, rounded to a
  /// power of two about as large as the bodies lie apart: differences to it are then mostly exact.
  [[nodiscard]] Eigen::Vector3d origin(const Eigen::Vector3d& current) const noexcept;

 private:
  std::array<std::array<double, kMost>, 3> position_;
  std::array<double, kMost> radius_;
  std::size_t count_ = 0;
};

}  // namespace winnow
