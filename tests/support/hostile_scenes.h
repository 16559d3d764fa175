#pragma once

#include <winnow/core/results.h>
#include <winnow/core/volumes.h>

#include <string>
#include <vector>

namespace winnow::test {

/// Boxes with their true pairs.
struct Scene {
  std::string name;
  std::vector<Aabb> boxes;
  std::vector<Pair> pairs;  ///< objects are numbered like the boxes
};

/// These scenes are created once per process, each with its true pairs.
[[nodiscard]] const std::vector<Scene>& random_scenes();
[[nodiscard]] const std::vector<Scene>& degenerate_scenes();
[[nodiscard]] const std::vector<Scene>& infinite_scenes();
[[nodiscard]] const std::vector<Scene>& extreme_float_scenes();
/// Uniform boxes, in numbers that make the last block of 16 or 256 empty, full or nearly so.
[[nodiscard]] const std::vector<Scene>& block_boundary_scenes();

}  // namespace winnow::test
