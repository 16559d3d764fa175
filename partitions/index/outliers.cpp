// Finds outliers for SpatialIndex::find_outliers; RebuildPlanner decides when.

#include "partitions/index/outliers.h"

#include "core/sort/order_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace winnow {
namespace {

// A block is searched for outliers if it is this many times as wide as a typical block after the
// build.
constexpr float kWide = 3.0F;
// An object is an outlier if its distance from the median of its block exceeds kFar times the
// median distance plus half the width of a wide block.
constexpr float kFar = 4.0F;

/// The objects of one block of rows.
struct BlockMembers {
  std::size_t count = 0;
  std::array<std::uint32_t, kBlockRows> row;
  std::array<std::array<float, kBlockRows>, 3> centre;

  BlockMembers(const BoundsPool& pool, std::size_t first) noexcept {
    const std::size_t last = std::min(first + kBlockRows, pool.rows());
    for (std::size_t at = first; at < last; ++at) {
      if (pool.ids()[at] == kNoObject) continue;
      for (std::size_t a = 0; a < 3; ++a) {
        centre[a][count] = 0.5F * pool.column(a)[at] + 0.5F * pool.column(3 + a)[at];
      }
      row[count++] = static_cast<std::uint32_t>(at);
    }
  }

  /// The distance of each object from the median, along the axis where it is largest.
  [[nodiscard]] std::array<float, kBlockRows> distances() const noexcept {
    std::array<float, kBlockRows> far{};
    for (const auto& along : centre) {
      const float middle = median_of(along, count);
      for (std::size_t i = 0; i < count; ++i) {
        far[i] = std::max(far[i], std::abs(along[i] - middle));
      }
    }
    return far;
  }
};

}  // namespace

std::size_t ordered_blocks(const Rows& rows, const BlockTree& tree) noexcept {
  return std::min(tree.blocks(), rows.regions().ordered / kBlockRows);
}

std::size_t count_wide_blocks(const Rows& rows, const BlockTree& tree, float edge) noexcept {
  return tree.count_wide(ordered_blocks(rows, tree), kWide * edge);
}

bool select_outliers(const Rows& rows, const BlockTree& tree, float edge,
                     std::size_t limit) noexcept {
  RowSelection& outliers = rows.selection();
  if (!outliers.start(limit + kBlockRows)) return false;
  const std::size_t blocks = ordered_blocks(rows, tree);
  for (std::size_t block = 0; block < blocks && outliers.list.size() < limit; ++block) {
    if (!tree.is_wide(block, kWide * edge)) continue;
    const BlockMembers objects(rows.pool(), (tree.first_block() + block) * kBlockRows);
    if (objects.count == 0) continue;
    const auto distance = objects.distances();
    const float far = kFar * median_of(distance, objects.count) + 0.5F * kWide * edge;
    for (std::size_t i = 0; i < objects.count; ++i) {
      if (distance[i] > far) outliers.add(objects.row[i]);
    }
  }
  return true;
}

}  // namespace winnow
