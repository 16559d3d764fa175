#pragma once

#include <winnow/core/volumes.h>

#include <cstddef>
#include <string>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {

/// The numbers from which the ends of boxes are drawn.
struct TinyScene {
  std::string name;
  std::vector<float> ends;
  double flat = 0.0;  ///< probability of an axis without extent
};

/// Returns four scenes: flat boxes in the planes of the axes; boxes with denormal sizes, positions
/// and gaps; boxes with sizes near the smallest normal number; and boxes of all these sizes among
/// ordinary ones.
[[nodiscard]] const std::vector<TinyScene>& tiny_scenes();

[[nodiscard]] std::vector<Aabb> boxes_of(const TinyScene& scene, std::size_t count, Random& random);

}  // namespace winnow::test
