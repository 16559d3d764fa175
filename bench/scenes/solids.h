#pragma once

#include <winnow/core/pose.h>
#include <winnow/core/regions.h>
#include <winnow/core/volumes.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace winnow::bench {

/// Oriented boxes that move a little in each frame; benchmarks of bounding volumes enclose them.
class Solids {
 public:
  /// Returns these boxes without rotation; unbounded ones are left out.
  static Solids of_boxes(std::span<const Aabb> boxes);
  /// Returns unit cubes of random orientation, about as dense as `uniform`.
  static Solids rotated(std::size_t objects, std::uint64_t seed);
  /// Returns boxes of proportions 1 : 1 : 20 in random orientations.
  static Solids rods(std::size_t objects, std::uint64_t seed);

  [[nodiscard]] std::size_t size() const noexcept { return boxes_.size(); }
  [[nodiscard]] const std::vector<OrientedBox>& boxes() const noexcept { return boxes_; }
  [[nodiscard]] std::vector<Aabb> bounds() const;
  /// Returns each object's box at an earlier position on its path: the position at which a fat AABB
  /// around it, with a margin of `share` times the longest edge of its bounds, was last refitted.
  /// The time since then is random. This is the state of a scene that has been moving for long.
  [[nodiscard]] std::vector<OrientedBox> boxes_at_last_refit(float share) const;
  [[nodiscard]] const ShapePool& shapes() const noexcept { return shapes_; }
  [[nodiscard]] Bodies bodies() const noexcept { return {ids_, poses_}; }

  /// Moves each object by `step` times its mean edge in its own direction.
  void advance(double step);

 private:
  void add(const Vec3f& center, const Vec3f& half, const Quaternion& turn);
  void add_turned(const Vec3d& center, const Vec3f& half, std::uint64_t seed);

  std::vector<OrientedBox> boxes_;
  std::vector<Pose> poses_;
  std::vector<ShapeId> ids_;
  std::vector<Vec3f> velocity_;
  ShapePool shapes_;
};

}  // namespace winnow::bench
