#pragma once

#include <gtest/gtest.h>
#include <winnow/winnow.h>

#include <vector>

namespace winnow::test {

/// Where a shape at a pose touches the floor, which is z <= 0 and is added to the pool.
inline std::vector<ContactPoint> contacts_on_floor(ShapePool& pool, ShapeId id, const Pose& pose,
                                                   double margin) {
  ShapeId floor;
  EXPECT_EQ(pool.add(HalfSpaceShape{}, floor), Status::ok);
  const std::vector<ShapeId> shapes{id, floor};
  const std::vector<Pose> poses{pose, Pose{}};
  const std::vector<BodyPair> pairs{{0, 1}};
  NarrowPhase narrow;
  NarrowResult result;
  EXPECT_EQ(narrow.collide(pool, {shapes, poses}, pairs,
                           {.level = ContactLevel::manifold, .margin = margin}, result),
            Status::ok);
  std::vector<ContactPoint> points;
  for (std::size_t i = 0; i < result.contacts(); ++i) points.push_back(result.contact(i));
  return points;
}

}  // namespace winnow::test
