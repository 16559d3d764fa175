#include "tests/support/tiny_boxes.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow::test {
namespace {

std::vector<float> of_both_signs(const std::vector<float>& sizes) {
  std::vector<float> ends{0.0F, -0.0F};
  for (const float size : sizes) {
    ends.push_back(size);
    ends.push_back(-size);
  }
  return ends;
}

std::vector<TinyScene> make_scenes() {
  constexpr float kSmallestFloat = std::numeric_limits<float>::denorm_min();
  constexpr float kNormal = std::numeric_limits<float>::min();
  const std::vector<float> denormal{
      kSmallestFloat, 2 * kSmallestFloat,     3 * kSmallestFloat, 1e-42F,
      1e-40F,         1e-40F + kSmallestFloat};
  const std::vector<float> border{kSmallestFloat, kNormal - kSmallestFloat,
                                  kNormal,        kNormal + kSmallestFloat,
                                  1.5F * kNormal, 2 * kNormal,
                                  1e-37F};
  std::vector<float> mixed{1.0F, std::nextafter(1.0F, 2.0F), 0x1p-103F, 3e-32F};
  mixed.insert(mixed.end(), denormal.begin(), denormal.end());
  mixed.insert(mixed.end(), border.begin(), border.end());
  return {{"flat", of_both_signs({1.0F, 2.0F}), 0.5},
          {"denormal", of_both_signs(denormal), 0.2},
          {"border", of_both_signs(border), 0.2},
          {"mixed", of_both_signs(mixed), 0.2}};
}

}  // namespace

const std::vector<TinyScene>& tiny_scenes() {
  static const std::vector<TinyScene> scenes = make_scenes();
  return scenes;
}

std::vector<Aabb> boxes_of(const TinyScene& scene, std::size_t count, Random& random) {
  const auto end = [&] { return scene.ends[random.below(scene.ends.size())]; };
  std::vector<Aabb> boxes(count);
  for (Aabb& box : boxes) {
    for (int axis = 0; axis < 3; ++axis) {
      const float a = end();
      const float b = random.chance(scene.flat) ? a : end();
      box.min[axis] = std::min(a, b);
      box.max[axis] = std::max(a, b);
    }
  }
  return boxes;
}

}  // namespace winnow::test
