#pragma once

#include <winnow/core/aabb.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::test {

/// Unit cubes, positions uniform in a cube of side cbrt(2 n): about two pairs per object.
[[nodiscard]] std::vector<Aabb> uniform_boxes(std::size_t count, std::uint64_t stream = 1);

/// A few dense Gaussian clusters.
[[nodiscard]] std::vector<Aabb> clustered_boxes(std::size_t count, std::uint64_t stream = 1);

/// Edges log-uniform over a ratio of 1000 to 1.
[[nodiscard]] std::vector<Aabb> mixed_boxes(std::size_t count, std::uint64_t stream = 1);

/// Every box spans the whole scene on `axis` and is small on the other two.
[[nodiscard]] std::vector<Aabb> wall_boxes(std::size_t count, int axis, std::uint64_t stream = 1);

/// Half of the boxes have extents and positions near 1e-20, half near 1e20; each half overlaps as
/// `uniform_boxes` does, and the small ones are inside few of the large ones.
[[nodiscard]] std::vector<Aabb> two_scale_boxes(std::size_t count, std::uint64_t stream = 1);

/// Uniform boxes and one at 1e30.
[[nodiscard]] std::vector<Aabb> outlier_boxes(std::size_t count, std::uint64_t stream = 1);

/// Sizes and positions that double from box to box, over 2^-100 .. 2^100; neighbours overlap.
[[nodiscard]] std::vector<Aabb> exponential_boxes(std::size_t count);

/// Thin and long along one axis each: some cross, most do not.
[[nodiscard]] std::vector<Aabb> rod_boxes(std::size_t count);

/// Four layers of small boxes on one ground box that touches all of the lowest layer.
[[nodiscard]] std::vector<Aabb> pile_boxes(std::size_t count);

}  // namespace winnow::test
