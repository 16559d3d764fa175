#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/oriented_box.h>
#include <winnow/core/pose.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace winnow::bench {

/// Boxes with an orientation that move a little in each frame: what bounding volumes are put
/// around.
class Solids {
 public:
  /// Boxes as they lie; unbounded ones are left out.
  static Solids of_boxes(std::span<const Aabb> boxes);
  /// Unit cubes in any orientation, about as dense as `uniform`.
  static Solids rotated(std::size_t objects, std::uint64_t seed);
  /// 1 : 1 : 20 in any orientation.
  static Solids rods(std::size_t objects, std::uint64_t seed);

  [[nodiscard]] std::size_t size() const noexcept { return boxes_.size(); }
  [[nodiscard]] const std::vector<OrientedBox>& boxes() const noexcept { return boxes_; }
  [[nodiscard]] std::vector<Aabb> bounds() const;
  /// Where each object was when it last left a margin of so much of its bounds' longest edge, at a
  /// time of its own: as partitions with margins find a scene that has been moving for long.
  [[nodiscard]] std::vector<OrientedBox> when_margins_were_left(float share) const;
  [[nodiscard]] const ShapePool& shapes() const noexcept { return shapes_; }
  [[nodiscard]] Bodies bodies() const noexcept { return {ids_, poses_}; }

  /// Each object becomes its box among these, of which the first ones of `of_boxes` were; it stays
  /// as it is where that is unbounded. Only for solids of boxes.
  void follow(std::span<const Aabb> boxes);
  /// Each object goes on by `step` times its mean edge, in a direction of its own.
  void advance(double step);

 private:
  ShapeId shape_of(const Eigen::Vector3f& half);
  void put(std::size_t i, const Eigen::Vector3f& center);
  void add(const OrientedBox& box, const double* quaternion);
  void add_turned(const Eigen::Vector3f& center, const Eigen::Vector3f& half, std::uint64_t seed);

  std::vector<OrientedBox> boxes_;
  std::vector<Pose> poses_;
  std::vector<ShapeId> ids_;
  std::vector<Eigen::Vector3f> way_;
  std::vector<std::size_t> row_;  // of boxes, among those they were made of
  ShapePool shapes_;
};

}  // namespace winnow::bench
