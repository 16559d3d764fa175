#pragma once

#include <winnow/core/volumes.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::test {

/// Unit cubes, positions uniform in a cube of side cbrt(2 n): about two pairs per object.
[[nodiscard]] std::vector<Aabb> uniform_boxes(std::size_t count, std::uint64_t stream = 1);

/// Four dense Gaussian clusters of unit cubes.
[[nodiscard]] std::vector<Aabb> clustered_boxes(std::size_t count, std::uint64_t stream = 1);

/// Edges log-uniform over a ratio of 1000 to 1.
[[nodiscard]] std::vector<Aabb> mixed_boxes(std::size_t count, std::uint64_t stream = 1);

/// Long boxes that all overlap each other on `axis`, with edges of 1 on the other two axes.
[[nodiscard]] std::vector<Aabb> wall_boxes(std::size_t count, int axis, std::uint64_t stream = 1);

/// Half of the boxes have extents and positions near 1e-20, half near 1e20. Within each half there
/// is about one pair per object. All small boxes are near the origin, so only large boxes that
/// contain the origin overlap them.
[[nodiscard]] std::vector<Aabb> two_scale_boxes(std::size_t count, std::uint64_t stream = 1);

/// Uniform boxes, except one box at 1e30.
[[nodiscard]] std::vector<Aabb> outlier_boxes(std::size_t count, std::uint64_t stream = 1);

/// Sizes and positions that grow by a constant factor from box to box, over 2^-100 .. 2^100.
/// Neighbours overlap if there are at least 413 boxes.
[[nodiscard]] std::vector<Aabb> exponential_boxes(std::size_t count);

/// Thin boxes, each long along one axis: some pairs cross, most do not.
[[nodiscard]] std::vector<Aabb> rod_boxes(std::size_t count);

/// Four layers of small boxes on one ground box that touches all of the lowest layer.
[[nodiscard]] std::vector<Aabb> pile_boxes(std::size_t count);

}  // namespace winnow::test
