#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/vec3.h>
#include <winnow/pipeline/cluster_transport.h>
#include <winnow/pipeline/shape_rays.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace winnow {

/// The point that two overlapping boxes share and whose rank reports them: on each axis the larger
/// of the two low corners (as Dittrich and Seeger 2000 do without duplicates in a spatial join).
[[nodiscard]] inline Vec3f meeting_point(const Vec3f& low_a, const Vec3f& low_b) noexcept {
  return low_a.max(low_b);
}

/// The middle of a box, a point of it also where it reaches to infinity.
[[nodiscard]] inline Vec3f centre_of(const Aabb& box) noexcept {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Vec3f centre;
  for (int axis = 0; axis < 3; ++axis) {
    const float low = box.min[axis];
    const float high = box.max[axis];
    // Halves do not overflow; the sum of two small ones may round out of the box.
    const bool finite = low != -infinity && high != infinity;
    centre[axis] = std::clamp(finite ? low * 0.5F + high * 0.5F : 0.0F, low, high);
  }
  return centre;
}

/// True if a box lies within another, borders included.
[[nodiscard]] inline bool contains(const Aabb& region, const Aabb& box) noexcept {
  return region.min.x() <= box.min.x() && box.max.x() <= region.max.x() &&
         region.min.y() <= box.min.y() && box.max.y() <= region.max.y() &&
         region.min.z() <= box.min.z() && box.max.z() <= region.max.z();
}

/// Which rank has which part of space: half-open boxes that leave nothing out.
class Regions {
 public:
  /// As the cuts say; none for one rank, which then has all of space.
  explicit Regions(std::span<const RegionCut> cuts = {});

  /// The rank of a point. O(depth of the cuts).
  [[nodiscard]] std::uint32_t owner(const Vec3f& point) const noexcept;
  /// The ranks whose regions a box meets, ascending; of an empty box none. O(ranks that it meets *
  /// depth).
  void ranks_of(const Aabb& box, std::vector<std::uint32_t>& ranks) const;
  /// The ranks whose regions a valid ray meets, or passes by so closely that rounding could tell
  /// otherwise; ascending. O(ranks that it meets * depth).
  void ranks_of(const ShapeRay& ray, std::vector<std::uint32_t>& ranks) const;
  /// The closed box of all floats in a rank's region.
  [[nodiscard]] const Aabb& of(std::uint32_t rank) const noexcept { return boxes_[rank]; }

 private:
  [[nodiscard]] std::int32_t root() const noexcept { return cuts_.empty() ? ~0 : 0; }
  void set_boxes(std::int32_t side, const Aabb& box);
  void add_ranks(std::int32_t side, const Aabb& box, std::vector<std::uint32_t>& ranks) const;
  /// Of the part of a ray from t = low to t = high.
  void add_ranks(std::int32_t side, const ShapeRay& ray, double low, double high,
                 std::vector<std::uint32_t>& ranks) const;

  std::vector<RegionCut> cuts_;
  std::vector<Aabb> boxes_;
};

}  // namespace winnow
