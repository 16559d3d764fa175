#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/pair_buffer.h>

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::test {

/// Boxes with their true pairs.
struct Scene {
  std::string name;
  std::vector<Aabb> boxes;
  std::vector<Pair> pairs;  ///< with objects numbered as the boxes are
};

/// Unit cubes, positions uniform in a cube of side cbrt(2 n): about two pairs an object.
[[nodiscard]] std::vector<Aabb> uniform_boxes(std::size_t count, std::uint64_t stream = 1);

/// A few dense Gaussian clusters.
[[nodiscard]] std::vector<Aabb> clustered_boxes(std::size_t count, std::uint64_t stream = 1);

/// Edges log-uniform over a ratio of 1000 to 1.
[[nodiscard]] std::vector<Aabb> mixed_boxes(std::size_t count, std::uint64_t stream = 1);

/// Every box spans the whole scene on `axis` and is small on the other two.
[[nodiscard]] std::vector<Aabb> wall_boxes(std::size_t count, int axis, std::uint64_t stream = 1);

/// Half of the boxes of extent and position about 1e-20, half about 1e20; each half overlaps as
/// `uniform_boxes` does, and the small ones lie inside few of the large ones.
[[nodiscard]] std::vector<Aabb> two_scale_boxes(std::size_t count, std::uint64_t stream = 1);

/// Uniform boxes and one at 1e30.
[[nodiscard]] std::vector<Aabb> outlier_boxes(std::size_t count, std::uint64_t stream = 1);

/// Sizes and positions that double from box to box, over 2^-100 .. 2^100; neighbours overlap.
[[nodiscard]] std::vector<Aabb> exponential_boxes(std::size_t count);

/// Made once per process, each with its true pairs.
[[nodiscard]] const std::vector<Scene>& random_scenes();
[[nodiscard]] const std::vector<Scene>& degenerate_scenes();
[[nodiscard]] const std::vector<Scene>& infinite_scenes();
[[nodiscard]] const std::vector<Scene>& extreme_float_scenes();
/// Uniform boxes, as many as make the last block of 16 or 256 empty, full or nearly so.
[[nodiscard]] const std::vector<Scene>& block_boundary_scenes();

}  // namespace winnow::test
