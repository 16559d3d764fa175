// Aabb: overlap, validity, conversion from doubles and origins, and the layouts that BoxView reads.

#include <gtest/gtest.h>
#include <winnow/core/volumes.h>
#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "core/numbers/rounding.h"

namespace winnow::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
const Aabb kUnit{{0, 0, 0}, {1, 1, 1}};

TEST(Aabb, boxes_that_touch_overlap) {
  for (int axis = 0; axis < 3; ++axis) {
    Aabb next = kUnit;
    next.min[axis] = 1.0F;
    next.max[axis] = 2.0F;
    EXPECT_TRUE(kUnit.overlaps(next));
    EXPECT_TRUE(next.overlaps(kUnit));
    next.min[axis] = std::nextafter(1.0F, 2.0F);
    EXPECT_FALSE(kUnit.overlaps(next));
    EXPECT_FALSE(next.overlaps(kUnit));
  }
}

TEST(Aabb, box_of_zero_extent_overlaps_itself) {
  const Aabb point{{1, 1, 1}, {1, 1, 1}};
  EXPECT_TRUE(point.is_valid());
  EXPECT_TRUE(point.overlaps(point));
  EXPECT_TRUE(point.overlaps(kUnit));
}

TEST(Aabb, default_box_is_empty_and_overlaps_nothing) {
  const Aabb everything{Eigen::Vector3f::Constant(-kInf), Eigen::Vector3f::Constant(kInf)};
  EXPECT_FALSE(Aabb{}.is_valid());
  EXPECT_FALSE(Aabb{}.overlaps(kUnit));
  EXPECT_FALSE(kUnit.overlaps(Aabb{}));
  EXPECT_FALSE(Aabb{}.overlaps(Aabb{}));
  EXPECT_FALSE(Aabb{}.overlaps({{-1e38F, -1e38F, -1e38F}, {1e38F, 1e38F, 1e38F}}));
  Aabb merged;
  merged.merge(kUnit);
  EXPECT_EQ(merged, kUnit);
  EXPECT_TRUE(everything.is_valid());
}

TEST(Aabb, nan_inverted_and_infinite_axes_are_invalid) {
  EXPECT_TRUE(kUnit.is_valid());
  for (int axis = 0; axis < 3; ++axis) {
    const auto with = [axis](float low, float high) {
      Aabb box = kUnit;
      box.min[axis] = low;
      box.max[axis] = high;
      return box.is_valid();
    };
    EXPECT_TRUE(with(-kInf, kInf));
    EXPECT_TRUE(with(-kInf, 0));
    EXPECT_TRUE(with(0, kInf));
    EXPECT_TRUE(with(0.0F, -0.0F));
    EXPECT_TRUE(with(-std::numeric_limits<float>::max(), std::numeric_limits<float>::max()));
    EXPECT_FALSE(with(kNan, 0));
    EXPECT_FALSE(with(0, kNan));
    EXPECT_FALSE(with(kNan, kNan));
    EXPECT_FALSE(with(std::nextafter(1.0F, 2.0F), 1));
    EXPECT_FALSE(with(kInf, kInf));
    EXPECT_FALSE(with(-kInf, -kInf));
    EXPECT_FALSE(with(kInf, -kInf));
  }
}

TEST(Aabb, box_with_a_nan_overlaps_nothing) {
  for (int axis = 0; axis < 3; ++axis) {
    Aabb bad = kUnit;
    bad.min[axis] = kNan;
    EXPECT_FALSE(bad.overlaps(kUnit));
    EXPECT_FALSE(kUnit.overlaps(bad));
  }
}

TEST(Aabb, box_from_doubles_contains_them) {
  const Eigen::Vector3d low(0.1, -0.1, 1e-300);
  const Eigen::Vector3d high(0.3, 1e300, 16777217.0);
  const Aabb box = Aabb::outward(low, high);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LE(static_cast<double>(box.min[axis]), low[axis]);
    EXPECT_GE(static_cast<double>(box.max[axis]), high[axis]);
  }
}

TEST(BoxView, arrays_columns_and_strided_members_read_alike) {
  struct Body {
    float low[3];
    double mass;
    float high[3];
  };
  const std::vector<Aabb> boxes{kUnit, {{2, 3, 4}, {5, 6, 7}}, {{-1, -2, -3}, {0, 0, 0}}};
  std::vector<Body> bodies;
  std::array<std::vector<float>, 6> columns;
  for (const Aabb& box : boxes) {
    bodies.push_back(
        {{box.min[0], box.min[1], box.min[2]}, 1.0, {box.max[0], box.max[1], box.max[2]}});
    for (int axis = 0; axis < 3; ++axis) {
      columns[static_cast<std::size_t>(axis)].push_back(box.min[axis]);
      columns[static_cast<std::size_t>(axis) + 3].push_back(box.max[axis]);
    }
  }
  const Body& b = bodies[0];
  const BoxView views[] = {BoxView(boxes),
                           BoxView({&b.low[0], &b.low[1], &b.low[2]},
                                   {&b.high[0], &b.high[1], &b.high[2]}, 3, sizeof(Body)),
                           BoxView({columns[0].data(), columns[1].data(), columns[2].data()},
                                   {columns[3].data(), columns[4].data(), columns[5].data()}, 3)};
  for (const BoxView& view : views) {
    ASSERT_EQ(view.count, 3U);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(view[i], boxes[i]);
  }
  EXPECT_EQ(BoxView(std::vector<Aabb>{}).count, 0U);
  EXPECT_EQ(BoxView().count, 0U);
}

TEST(Aabb, box_relative_to_a_far_origin_is_tight) {
  const Eigen::Vector3d low(0.25, -1.5, 3.0);
  const Eigen::Vector3d high(0.75, 1.5, 3.0);
  const Eigen::Vector3d origin(1e8, -1e9, 1e12);
  EXPECT_EQ(Aabb::outward(origin + low, origin + high, origin), Aabb::outward(low, high));
  EXPECT_EQ(Aabb::outward(low, high, Eigen::Vector3d::Zero()), Aabb::outward(low, high));
}

// Multiples of 2^-16 below 2^36 are doubles, and their differences are exact in integers.
TEST(Aabb, box_relative_to_an_origin_contains_exact_differences) {
  std::mt19937_64 random(7);
  const auto draw = [&](int bits) {
    std::uniform_int_distribution<std::int64_t> all(-(std::int64_t{1} << bits),
                                                    std::int64_t{1} << bits);
    return all(random);
  };
  for (int round = 0; round < 20'000; ++round) {
    Eigen::Vector3d low;
    Eigen::Vector3d high;
    Eigen::Vector3d origin;
    std::array<std::array<std::int64_t, 2>, 3> exact{};
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t from = draw(51);
      const std::int64_t at = from + draw(round % 40);
      const std::int64_t to = at + std::abs(draw(round % 30));
      origin[axis] = std::ldexp(static_cast<double>(from), -16);
      low[axis] = std::ldexp(static_cast<double>(at), -16);
      high[axis] = std::ldexp(static_cast<double>(to), -16);
      exact[static_cast<std::size_t>(axis)] = {at - from, to - from};
    }
    const Aabb box = Aabb::outward(low, high, origin);
    for (int axis = 0; axis < 3; ++axis) {
      const auto [least, most] = exact[static_cast<std::size_t>(axis)];
      const auto units = [](float value) { return std::ldexp(static_cast<double>(value), 16); };
      EXPECT_LE(units(box.min[axis]), static_cast<double>(least));
      EXPECT_GE(units(box.max[axis]), static_cast<double>(most));
      EXPECT_GT(units(next_up(box.min[axis])), static_cast<double>(least));
      EXPECT_LT(units(-next_up(-box.max[axis])), static_cast<double>(most));
    }
  }
}

}  // namespace
}  // namespace winnow::test
