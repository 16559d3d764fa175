// Boxes that just touch a region overlap it, and boxes that are one unit farther out do not,
// although the difference of their distances is below the precision of float. All coordinates are
// integers, so that 64 bits suffice for every square and product.

#include <winnow/partitions/partition.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr std::int64_t kRadius = 1 << 20;

/// Returns a box whose corner nearest to the origin, or to an axis, is (x, y, z) >= 0.
Aabb box_from(std::int64_t x, std::int64_t y, std::int64_t z) {
  const Vec3f corner(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  return {corner, corner + Vec3f::constant(64.0F)};
}

/// Boxes, and which of them overlap a region.
struct Boxes {
  std::vector<Aabb> all;
  std::vector<ObjectId> overlapping;  // their indices

  void add(const Aabb& box, bool overlaps) {
    if (overlaps) overlapping.push_back(static_cast<ObjectId>(all.size()));
    all.push_back(box);
  }
};

void expect_overlap(const Boxes& boxes, const Region& region) {
  for (const StructureKind structure : {bounds_n_squared(), linear_bvh(), flat_grid()}) {
    SCOPED_TRACE(structure.name());
    Partition partition(structure);
    std::vector<Key> keys(boxes.all.size());
    ASSERT_EQ(partition.insert(boxes.all, {}, keys), Status::ok);
    OverlapBuffer buffer;
    ASSERT_EQ(partition.overlap(region, buffer, {}, Order::canonical), Status::ok);
    std::vector<ObjectId> found(buffer.ids().begin(), buffer.ids().end());
    std::ranges::sort(found);
    EXPECT_EQ(found, boxes.overlapping);
  }
}

/// Returns boxes with a corner within one unit of the circle or ball of `kRadius`, in the first two
/// or all three coordinates.
Boxes boxes_at_ball(int axes) {
  Random random(4);
  Boxes boxes;
  const auto below = [&](std::int64_t most) {
    return static_cast<std::int64_t>(random.below(static_cast<std::size_t>(most)));
  };
  for (int i = 0; i < 300; ++i) {
    const std::int64_t z = below(1000);
    // The last x that touches the surface from inside; x + 1 is outside.
    const std::int64_t y = below(2000);
    const std::int64_t rest = kRadius * kRadius - y * y - (axes == 3 ? z * z : 0);
    std::int64_t x = kRadius;
    while (x * x > rest) --x;
    for (const std::int64_t at : {x, x + 1}) {
      boxes.add(i % 2 == 0 ? box_from(at, y, z) : box_from(y, at, z), at == x);
    }
  }
  return boxes;
}

TEST(RegionEnds, spheres_overlap_exactly_at_their_surface) {
  const Boxes boxes = boxes_at_ball(3);
  expect_overlap(boxes, Sphere{{0, 0, 0}, static_cast<float>(kRadius)});
  expect_overlap(boxes, Capsule{{0, 0, 0}, {0, 0, 0}, static_cast<float>(kRadius)});
}

TEST(RegionEnds, capsules_overlap_exactly_at_their_surface) {
  expect_overlap(boxes_at_ball(2), Capsule{{0, 0, -5000}, {0, 0, 5000}, float{kRadius}});
}

TEST(RegionEnds, planes_separate_exactly_at_their_surface) {
  Random random(5);
  const auto below = [&](int most) {
    return static_cast<std::int64_t>(random.below(static_cast<std::size_t>(most)));
  };
  // One plane decides, without other planes or with five others.
  for (const std::size_t count : {1U, 6U}) {
    for (int round = 0; round < 20; ++round) {
      const std::array<std::int64_t, 3> normal{1, 1 + below(3), below(3)};
      constexpr std::int64_t kOffset = 5'000'001;
      std::vector<Plane> planes(count, {{1, 0, 0}, 3e7F});
      planes[0].normal = {static_cast<float>(normal[0]), static_cast<float>(normal[1]),
                          static_cast<float>(normal[2])};
      planes[0].offset = -static_cast<float>(kOffset);
      Boxes boxes;
      for (int i = 0; i < 40; ++i) {
        const std::int64_t y = below(1'000'000);
        const std::int64_t z = below(1'000'000);
        const std::int64_t x = kOffset - normal[1] * y - normal[2] * z;
        for (const std::int64_t at : {x - 1, x}) {
          const Vec3f corner(static_cast<float>(at), static_cast<float>(y), static_cast<float>(z));
          boxes.add({corner - Vec3f::constant(64.0F), corner}, at == x);
        }
      }
      expect_overlap(boxes, std::span<const Plane>(planes));
      if (count != 6) continue;
      Frustum frustum;
      std::ranges::copy(planes, frustum.planes.begin());
      expect_overlap(boxes, frustum);
    }
  }
}

}  // namespace
}  // namespace winnow::test
