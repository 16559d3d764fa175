#include "tests/support/motion.h"
#include <winnow/core/eigen.h>

#include <utility>

namespace winnow::test {
namespace {

void shift(Aabb& box, double distance, Random& random) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto by = static_cast<float>(random.uniform(-distance, distance));
    box.min[axis] += by;
    box.max[axis] += by;
  }
}

void teleport(std::vector<Aabb>& boxes, std::size_t i, Random& random) {
  std::swap(boxes[i], boxes[random.below(boxes.size())]);
  if (random.chance(0.1))
    as_eigen(boxes[i].max).array() += static_cast<float>(random.uniform(0.0, 2.0));
  if (random.chance(0.1)) boxes[i].max = boxes[i].min;
}

}  // namespace

const char* to_string(Motion motion) {
  switch (motion) {
    case Motion::little:
      return "little";
    case Motion::much:
      return "much";
    case Motion::few:
      return "few";
    case Motion::teleport:
      return "teleport";
    case Motion::still:
      return "still";
  }
  return "unknown";
}

std::vector<std::size_t> move(Motion motion, std::vector<Aabb>& boxes, Random& random) {
  const std::vector<Aabb> before = boxes;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    switch (motion) {
      case Motion::little:
        shift(boxes[i], 0.05, random);
        break;
      case Motion::much:
        shift(boxes[i], 5.0, random);
        break;
      case Motion::few:
        if (random.chance(0.05)) shift(boxes[i], 1.0, random);
        break;
      case Motion::teleport:
        teleport(boxes, i, random);
        break;
      case Motion::still:
        break;
    }
  }
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!(boxes[i] == before[i])) changed.push_back(i);
  }
  return changed;
}

}  // namespace winnow::test
