// SpatialIndex: finds outliers, which are objects that jumped away from the other objects in their
// block of the tree, and moves them to the tail. refresh() calls it after refitting the trees.

#include "partitions/index/spatial_index.h"

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
// Searching a block costs this many tests for each of its rows.
constexpr std::uint64_t kSearchCost = 16;
// There is no search if fewer than one object in this many changed: then wear, which is counted in
// tests, leads to a build if it is necessary.
constexpr std::size_t kFewChanges = 256;
// There is no search either if few blocks became wide: the limit is the price of a build (in tests)
// divided by this number.
constexpr std::size_t kWearOfPrice = 512;

/// The bounded objects of one block of rows.
struct BlockMembers {
  std::size_t count = 0;
  std::array<std::uint32_t, kBlockRows> row;
  std::array<std::array<float, kBlockRows>, 3> centre;

  BlockMembers(const BoundsPool& pool, std::size_t first) noexcept {
    const std::size_t last = std::min(first + kBlockRows, pool.rows());
    for (std::size_t at = first; at < last; ++at) {
      if (pool.ids()[at] == kNoObject) continue;
      float sum = 0.0F;
      for (std::size_t a = 0; a < 3; ++a) {
        centre[a][count] = 0.5F * pool.column(a)[at] + 0.5F * pool.column(3 + a)[at];
        sum += centre[a][count];
      }
      row[count] = static_cast<std::uint32_t>(at);
      count += std::isfinite(sum) ? 1U : 0U;
    }
  }

  [[nodiscard]] float median_of(std::array<float, kBlockRows> values) const noexcept {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(count));
    return *middle;
  }

  /// The distance of each object from the median, along the axis where it is largest.
  [[nodiscard]] std::array<float, kBlockRows> distances() const noexcept {
    std::array<float, kBlockRows> far{};
    for (const auto& along : centre) {
      const float middle = median_of(along);
      for (std::size_t i = 0; i < count; ++i) {
        far[i] = std::max(far[i], std::abs(along[i] - middle));
      }
    }
    return far;
  }
};

}  // namespace

// The number of full blocks in the order of the last build.
std::size_t SpatialIndex::ordered_blocks() const noexcept {
  return std::min(tree_.blocks(), rows_.regions().ordered / kBlockRows);
}

std::size_t SpatialIndex::wide_blocks() const noexcept {
  return tree_.count_wide(ordered_blocks(), kWide * built_edge_);
}

// An outlier makes the box of its block overlap many others. Blocks that became wide since the last
// search may contain one.
Status SpatialIndex::find_outliers() {
  const bool few = !rows_.stale().all() && rows_.stale().ids().size() * kFewChanges < rows_.size();
  if (few || rows_.regions().regular != 0 || !(built_edge_ > 0.0F)) return Status::ok;
  const std::size_t wide = wide_blocks();
  known_wide_ = std::min(known_wide_, wide);
  const std::uint64_t price = structure_->build_price() * ordered_blocks();
  if (wide <= known_wide_ + price / kWearOfPrice) return Status::ok;
  // If the search would cost more than a build, build instead.
  return wide * kSearchCost > price ? build() : move_outliers_to_tail();
}

// Lists outliers block by block until there are at least `limit`. Returns false if an allocation
// fails.
bool SpatialIndex::collect_outliers(std::size_t limit) noexcept {
  RowSelection& outliers = rows_.selection();
  if (!outliers.start(limit + kBlockRows)) return false;
  const std::size_t blocks = ordered_blocks();
  for (std::size_t block = 0; block < blocks && outliers.list.size() < limit; ++block) {
    if (!tree_.is_wide(block, kWide * built_edge_)) continue;
    const BlockMembers objects(rows_.pool(), (tree_.first_block() + block) * kBlockRows);
    if (objects.count == 0) continue;
    const auto distance = objects.distances();
    const float far = kFar * objects.median_of(distance) + 0.5F * kWide * built_edge_;
    for (std::size_t i = 0; i < objects.count; ++i) {
      if (distance[i] > far) outliers.add(objects.row[i]);
    }
  }
  return true;
}

// Moves the outliers to the tail, which is sorted by position. Builds instead if the tail would
// exceed its limit.
Status SpatialIndex::move_outliers_to_tail() {
  const std::size_t limit = tail_limit();
  const std::size_t room = limit + 1 - std::min(limit, tail());
  if (!collect_outliers(room)) return Status::out_of_memory;
  RowSelection& outliers = rows_.selection();
  if (outliers.list.size() >= room) return build();
  if (!outliers.list.empty()) {
    // The rows of a plan must stay in place, but outliers are moved.
    drop_plan();
    order_changed_ = true;
    if (!move_to_tail(outliers.entries()) || !sort_tail() || !refit_trees()) {
      return Status::out_of_memory;
    }
  }
  known_wide_ = wide_blocks();
  return Status::ok;
}

}  // namespace winnow
