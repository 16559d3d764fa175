#pragma once

#include <winnow/core/vectors.h>
#include <winnow/core/volumes.h>
#include <winnow/pipeline/cluster_transport.h>
#include <winnow/pipeline/shape_rays.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace winnow {

/// Reference point of two overlapping boxes: on each axis the larger of the two low corners. The
/// rank whose region contains it reports the pair (Dittrich and Seeger 2000 avoid duplicates in a
/// spatial join in this way).
[[nodiscard]] inline Vec3f reference_point(const Vec3f& low_a, const Vec3f& low_b) noexcept {
  return low_a.max(low_b);
}

/// Returns the centre of a box; on an axis on which the box is infinite, the coordinate in the box
/// that is closest to 0.
[[nodiscard]] inline Vec3f centre_of(const Aabb& box) noexcept {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Vec3f centre;
  for (int axis = 0; axis < 3; ++axis) {
    const float low = box.min[axis];
    const float high = box.max[axis];
    // Halving first avoids overflow. Halves of subnormal numbers are rounded, so their sum may be
    // outside of the box: clamp it.
    const bool finite = low != -infinity && high != infinity;
    centre[axis] = std::clamp(finite ? low * 0.5F + high * 0.5F : 0.0F, low, high);
  }
  return centre;
}

/// True if `box` is contained in `region`, borders included.
[[nodiscard]] inline bool contains(const Aabb& region, const Aabb& box) noexcept {
  return region.min.x() <= box.min.x() && box.max.x() <= region.max.x() &&
         region.min.y() <= box.min.y() && box.max.y() <= region.max.y() &&
         region.min.z() <= box.min.z() && box.max.z() <= region.max.z();
}

/// The region of each rank: half-open boxes that partition space.
class Regions {
 public:
  /// Regions given by cuts. Without cuts there is one rank, which has all of space.
  explicit Regions(std::span<const SplitPlane> cuts = {});

  /// Returns the rank whose region contains a point. O(depth of the cuts).
  [[nodiscard]] std::uint32_t owner(const Vec3f& point) const noexcept;
  /// Returns the ranks whose regions a box overlaps, ascending; none for an empty box. O(ranks *
  /// depth).
  void ranks_of(const Aabb& box, std::vector<std::uint32_t>& ranks) const;
  /// Returns the ranks whose regions a valid ray intersects, or misses by no more than rounding
  /// errors, ascending. O(ranks * depth).
  void ranks_of(const ShapeRay& ray, std::vector<std::uint32_t>& ranks) const;
  /// The smallest closed box that contains all points of a rank's region with float coordinates.
  [[nodiscard]] const Aabb& of(std::uint32_t rank) const noexcept { return boxes_[rank]; }

 private:
  [[nodiscard]] std::int32_t root() const noexcept { return cuts_.empty() ? ~0 : 0; }
  void set_boxes(std::int32_t side, const Aabb& box);
  void add_ranks(std::int32_t side, const Aabb& box, std::vector<std::uint32_t>& ranks) const;
  /// Adds the ranks of the part of a ray from t = low to t = high.
  void add_ranks(std::int32_t side, const ShapeRay& ray, double low, double high,
                 std::vector<std::uint32_t>& ranks) const;

  std::vector<SplitPlane> cuts_;
  std::vector<Aabb> boxes_;
};

}  // namespace winnow
