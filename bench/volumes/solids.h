#pragma once

#include <winnow/core/kdop.h>
#include <winnow/core/oriented_box.h>
#include <winnow/core/pose.h>
#include <winnow/core/rounding.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// Boxes with an orientation that move a little in each frame: what bounding volumes are put
/// around.
class Solids {
 public:
  /// The boxes of a built-in scene, as they lie.
  static Solids of_scene(const std::string& name, std::size_t objects, std::uint64_t seed);
  /// Unit cubes in any orientation, about as dense as `uniform`.
  static Solids rotated(std::size_t objects, std::uint64_t seed);
  /// 1 : 1 : 20 in any orientation.
  static Solids rods(std::size_t objects, std::uint64_t seed);

  [[nodiscard]] std::size_t size() const noexcept { return boxes_.size(); }
  [[nodiscard]] const std::vector<OrientedBox>& boxes() const noexcept { return boxes_; }
  [[nodiscard]] const ShapePool& shapes() const noexcept { return shapes_; }
  [[nodiscard]] Bodies bodies() const noexcept { return {ids_, poses_}; }

  /// Each object goes on by `step` times its mean edge, in a direction of its own.
  void advance(double step);

 private:
  void add(const OrientedBox& box, const double* quaternion);
  void add_turned(const Eigen::Vector3f& center, const Eigen::Vector3f& half, std::uint64_t seed);

  std::vector<OrientedBox> boxes_;
  std::vector<Pose> poses_;
  std::vector<ShapeId> ids_;
  std::vector<Eigen::Vector3f> way_;
  ShapePool shapes_;
};

/// A k-DOP of a rotated box, at most two ulp larger than the tightest in any slab.
template <int K>
[[nodiscard]] Kdop<K> kdop_around(const OrientedBox& box) noexcept {
  Kdop<K> result;
  constexpr auto directions = kdop_directions<K>();
  for (std::size_t s = 0; s < Kdop<K>::kSlabs; ++s) {
    double center = 0.0;
    double size = 0.0;
    double half[3] = {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      const double weight = directions[s][axis];
      center += weight * static_cast<double>(box.center[a]);
      size += std::abs(static_cast<double>(box.center[a])) + static_cast<double>(box.half[a]);
      for (Eigen::Index i = 0; i < 3; ++i) half[i] += weight * static_cast<double>(box.axes(a, i));
    }
    // More than the rounding of all sums: a few 2^-53 of their terms.
    double reach = 4e-15 * size;
    for (Eigen::Index i = 0; i < 3; ++i) {
      reach += std::abs(half[i]) * static_cast<double>(box.half[i]);
    }
    result.min[s] = round_down(center - reach);
    result.max[s] = round_up(center + reach);
  }
  return result;
}

}  // namespace winnow::bench
