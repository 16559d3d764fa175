// Tests conversions of volumes with tiny coordinates in every floating-point mode that a host
// program may set: each rounding direction, with and without flushing of denormal numbers.

#include <gtest/gtest.h>
#include <winnow/core/regions.h>
#include <winnow/core/volumes.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tests/support/exact.h"
#include "tests/support/float_modes.h"
#include "tests/support/tiny_boxes.h"

namespace winnow::test {
namespace {

std::vector<Aabb> tiny_boxes() {
  std::vector<Aabb> boxes;
  Random random(72);
  for (const TinyScene& scene : tiny_scenes()) {
    for (const Aabb& box : boxes_of(scene, scaled(60), random)) boxes.push_back(box);
  }
  return boxes;
}

/// Returns make(box) for each box, computed in a floating-point mode.
template <typename Make>
auto made_in(const FloatMode& mode, const std::vector<Aabb>& boxes, Make&& make) {
  std::vector<decltype(make(boxes[0]))> made;
  made.reserve(boxes.size());
  const FloatModeScope scope(mode);
  for (const Aabb& box : boxes) made.push_back(make(box));
  return made;
}

/// Returns all floats of a volume. The sign of a 0 depends on the rounding direction.
template <typename Made>
auto floats_of(const Made& made) {
  return std::bit_cast<std::array<float, sizeof(Made) / sizeof(float)>>(made);
}

template <typename Make>
void expect_the_same_in_every_mode(Make&& make) {
  const std::vector<Aabb> boxes = tiny_boxes();
  const auto standard = made_in({}, boxes, make);
  for (const FloatMode& mode : all_float_modes()) {
    const auto made = made_in(mode, boxes, make);
    std::size_t others = 0;
    for (std::size_t i = 0; i < made.size(); ++i) {
      others += floats_of(made[i]) == floats_of(standard[i]) ? 0U : 1U;
    }
    EXPECT_EQ(others, 0U) << "of " << made.size() << ", " << to_string(mode);
  }
}

TEST(TinyVolumes, bounds_are_equal_in_every_float_mode) {
  expect_the_same_in_every_mode([](const Aabb& box) {
    return Sphere{box.min,
                  std::bit_cast<float>(std::bit_cast<std::uint32_t>(box.max.x()) & 0x7FFFFFFFU)}
        .bounds();
  });
  expect_the_same_in_every_mode([](const Aabb& box) {
    return Capsule{box.min, box.max, 0.0F}.bounds();
  });
  expect_the_same_in_every_mode([](const Aabb& box) {
    Aabb merged{box.min, box.min};
    merged.merge({box.max, box.max});
    return merged;
  });
}

TEST(TinyVolumes, boxes_from_an_origin_are_equal_in_modes) {
  Random random(73);
  std::vector<double> numbers{0.0, -0.0, 1.0, 0x1p-1074, -0x1p-1074, 0x1p-1022, -0x1p-960};
  while (numbers.size() < scaled(300)) {
    const double size = random.log_uniform(1e-320, 1e-30);
    numbers.push_back(random.chance(0.5) ? size : -size);
  }
  const auto some_point = [&] {
    const auto some = [&] { return numbers[random.below(numbers.size())]; };
    return Vec3d(some(), some(), some());
  };
  for (std::size_t i = 0; i < scaled(300); ++i) {
    const Vec3d min = some_point();
    const Vec3d max = some_point();
    const Vec3d origin = random.chance(0.2) ? min : some_point();
    const Aabb standard = Aabb::outward(min, max, origin);
    for (const FloatMode& mode : all_float_modes()) {
      Aabb box;
      {
        const FloatModeScope scope(mode);
        box = Aabb::outward(min, max, origin);
      }
      EXPECT_EQ(floats_of(box), floats_of(standard)) << to_string(mode);
    }
  }
}

TEST(TinyVolumes, kdops_are_equal_in_every_float_mode) {
  expect_the_same_in_every_mode([](const Aabb& box) { return Kdop<26>::around(box); });
  expect_the_same_in_every_mode([](const Aabb& box) {
    const std::vector<Vec3f> points{box.min, box.max};
    return Kdop<14>::around(PointView(std::span<const Vec3f>(points)));
  });
}

OrientedBox oriented(const Aabb& box) {
  const auto size = [](float x) {
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) & 0x7FFFFFFFU);
  };
  OrientedBox result{box.min, {size(box.max.x()), size(box.max.y()), size(box.max.z())}};
  constexpr float kAxes[3][3] = {{0.8F, 0.1F, -0.3F}, {0.2F, 0.9F, 0.1F}, {0.3F, -0.2F, 0.7F}};
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) result.axes(i, k) = kAxes[i][k];
  }
  return result;
}

/// The centre of a box along an integer direction, and its extent from there.
struct Span {
  Exact middle;
  Exact reach;
};
Span span_of(const OrientedBox& box, const std::array<int, 3>& direction) {
  Span span{0.0, 0.0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    span.middle = span.middle + Exact(direction[axis]) * Exact(box.center[axis]);
  }
  for (int i = 0; i < 3; ++i) {
    Exact edge(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      edge = edge + Exact(direction[static_cast<std::size_t>(axis)]) * Exact(box.axes(axis, i)) *
                        Exact(box.half[i]);
    }
    span.reach = span.reach + abs(edge);
  }
  return span;
}

TEST(TinyVolumes, rotated_boxes_stay_inside_in_every_mode) {
  const std::vector<Aabb> boxes = tiny_boxes();
  const auto directions = kdop_directions<26>();
  for (const FloatMode& mode : all_float_modes()) {
    const auto bounds = made_in(mode, boxes, [](const Aabb& b) { return oriented(b).bounds(); });
    const auto kdops =
        made_in(mode, boxes, [](const Aabb& b) { return kdop_around<26>(oriented(b)); });
    std::size_t outside = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t s = 0; s < directions.size(); ++s) {
        const auto [middle, reach] = span_of(oriented(boxes[i]), directions[s]);
        const bool inside = Exact(kdops[i].min[s]) <= middle - reach &&
                            middle + reach <= Exact(kdops[i].max[s]) &&
                            (s >= 3 || (Exact(bounds[i].min[s]) <= middle - reach &&
                                        middle + reach <= Exact(bounds[i].max[s])));
        outside += inside ? 0U : 1U;
      }
    }
    EXPECT_EQ(outside, 0U) << "of " << boxes.size() * directions.size() << ", " << to_string(mode);
  }
}

TEST(TinyVolumes, boxes_stay_inside_their_spheres_in_every_mode) {
  const std::vector<Aabb> boxes = tiny_boxes();
  for (const FloatMode& mode : all_float_modes()) {
    const auto spheres = made_in(mode, boxes, [](const Aabb& b) { return Sphere::around(b); });
    std::size_t outside = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      Exact square(0.0);
      for (int k = 0; k < 3; ++k) {
        const Exact below = Exact(spheres[i].center[k]) - Exact(boxes[i].min[k]);
        const Exact above = Exact(boxes[i].max[k]) - Exact(spheres[i].center[k]);
        const Exact reach = below <= above ? above : below;
        square = square + reach * reach;
      }
      const Exact radius(spheres[i].radius);
      outside += square <= radius * radius ? 0U : 1U;
    }
    EXPECT_EQ(outside, 0U) << "of " << boxes.size() << ", " << to_string(mode);
  }
}

}  // namespace
}  // namespace winnow::test
