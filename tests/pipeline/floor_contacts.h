#pragma once

#include <gtest/gtest.h>
#include <winnow/winnow.h>
#include "tests/support/answers.h"

#include <vector>

namespace winnow::test {

/// Returns the contacts of a shape with the floor z <= 0, which is added to the pool.
inline std::vector<ContactPoint> contacts_on_floor(ShapePool& pool, ShapeId id, const Pose& pose,
                                                   double margin) {
  ShapeId floor = expect_ok(pool.add(HalfSpaceShape{}));
  const std::vector<ShapeId> shapes{id, floor};
  const std::vector<Pose> poses{pose, Pose{}};
  const std::vector<BodyPair> pairs{{0, 1}};
  NarrowPhase narrow;
  NarrowResult result;
  EXPECT_EQ(narrow.collide(pool, {shapes, poses}, pairs,
                           {.level = ContactLevel::manifold, .contact_margin = margin}, result),
            Status::ok);
  std::vector<ContactPoint> points;
  for (std::size_t i = 0; i < result.contacts(); ++i) points.push_back(result.contact(i));
  return points;
}

}  // namespace winnow::test
