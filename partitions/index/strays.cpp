// Objects of a tree that have jumped away from those they share a block with.

#include "partitions/index/spatial_index.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace winnow {
namespace {

// Blocks are looked into that are so many times as wide as blocks were when they were built.
constexpr float kWide = 3.0F;
// An object has jumped away if it is so many times as far from the middle of its block as half of
// the others are, and by half the width of such a block more.
constexpr float kFar = 4.0F;
// Looking into a block takes as long as so many tests for each of its rows.
constexpr std::uint64_t kLook = 16;
// Of fewer changes, one in so many, wear tells soon enough.
constexpr std::size_t kFewChanges = 256;
// So does it of few blocks: what costs more to build is kept while it wears further.
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

  /// How far each object is from the middle, along the axis where that is farthest.
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

// Blocks of rows that the last order put there.
std::size_t SpatialIndex::ordered_blocks() const noexcept {
  return std::min(tree_.blocks(), rows_.regions().ordered / kBlockRows);
}

std::size_t SpatialIndex::wide_blocks() const noexcept {
  return tree_.count_wide(ordered_blocks(), kWide * built_edge_);
}

// An object that jumps makes its block meet all others. Blocks that have become wide since the last
// look tell that there may be some.
Status SpatialIndex::look_for_strays() {
  const bool few = !rows_.stale().all() && rows_.stale().ids().size() * kFewChanges < rows_.size();
  if (few || rows_.regions().regular != 0 || !(built_edge_ > 0.0F)) return Status::ok;
  const std::size_t wide = wide_blocks();
  known_wide_ = std::min(known_wide_, wide);
  const std::uint64_t price = structure_->build_price() * ordered_blocks();
  if (wide <= known_wide_ + price / kWearOfPrice) return Status::ok;
  // Where looking into them costs more than a build, that is done.
  return wide * kLook > price ? build() : take_out_strays();
}

// Lists them, up to a limit. False if memory is refused.
bool SpatialIndex::collect_strays(std::size_t limit) noexcept {
  RowSelection& strays = rows_.selection();
  if (!strays.start(limit + kBlockRows)) return false;
  const std::size_t blocks = ordered_blocks();
  for (std::size_t block = 0; block < blocks && strays.list.size() < limit; ++block) {
    if (!tree_.is_wide(block, kWide * built_edge_)) continue;
    const BlockMembers objects(rows_.pool(), (tree_.first_block() + block) * kBlockRows);
    if (objects.count == 0) continue;
    const auto distance = objects.distances();
    const float far = kFar * objects.median_of(distance) + 0.5F * kWide * built_edge_;
    for (std::size_t i = 0; i < objects.count; ++i) {
      if (distance[i] > far) strays.add(objects.row[i]);
    }
  }
  return true;
}

// Puts them behind the rows in order, where they are sorted by place. More than may stand there
// want a build.
Status SpatialIndex::take_out_strays() {
  const std::size_t limit = tail_limit();
  const std::size_t room = limit + 1 - std::min(limit, tail());
  if (!collect_strays(room)) return Status::out_of_memory;
  RowSelection& strays = rows_.selection();
  if (strays.list.size() >= room) return build();
  if (!strays.list.empty()) {
    // The rows of a plan have to stay in their order, and these are in none.
    give_up_plan();
    order_changed_ = true;
    if (!move_to_tail(strays.entries()) || !sort_tail() || !refit_trees()) {
      return Status::out_of_memory;
    }
  }
  known_wide_ = wide_blocks();
  return Status::ok;
}

}  // namespace winnow
