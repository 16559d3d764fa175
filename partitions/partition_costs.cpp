#include <winnow/partitions/partition_costs.h>

#include <algorithm>
#include <bit>

namespace winnow {
namespace {

/// See PartitionCosts. Nanoseconds.
struct Constants {
  std::string_view name;
  double object, level, pair, spread, crowd, square;
  double moved, rest;
  double ask, ask_level, scan, rows;
};

constexpr std::array<Constants, kPartitionKinds> kConstants{{
    {"BoundsNSquared", 8, 0.5, 2, 0, 0, 0.12, 20, 0.3, 60, 0, 0.12, 0},
    {"SweepAndPrune", 30, 2.0, 4, 2, 3, 0, 60, 1.0, 60, 20, 0, 1.5},
    {"FlatGrid", 30, 2.0, 4, 2, 3, 0, 60, 1.0, 60, 20, 0, 1.5},
    {"LinearBvh", 15, 1.5, 4, 2, 2, 0, 50, 0.6, 60, 20, 0, 0},
}};

}  // namespace

PartitionCosts::PartitionCosts(const SceneFeatures& scene, const FrameWork& frame,
                               double pairs) noexcept {
  const auto n = static_cast<double>(scene.objects);
  const auto changed = static_cast<double>(std::min(frame.changed, scene.objects));
  const double level = static_cast<double>(std::bit_width(scene.objects));
  // Past a quarter of the objects partitions follow no single changes.
  const bool much = 4.0 * changed > n;
  const auto queries = static_cast<double>(frame.pair_queries);
  const double full = much ? queries : static_cast<double>(frame.full_queries);
  const double partial = queries - full;
  const auto others = static_cast<double>(frame.casts + frame.regions + frame.nearest);
  for (std::size_t k = 0; k < kPartitionKinds; ++k) {
    const Constants& c = kConstants[k];
    const double all = c.object + c.level * level + c.spread * scene.size_spread +
                       c.crowd * scene.crowding + c.square * n;
    const double one = c.moved + c.level * level + c.square * n;
    double sum = full * (n * all + c.pair * pairs);
    sum += partial * (changed * one + (n > 0.0 ? changed / n : 0.0) * c.pair * pairs + c.rest * n);
    queries_[k] = others * (c.ask + c.ask_level * level + c.scan * n);
    if (others > 0.0) queries_[k] += c.rows * (much ? n : changed);
    total_[k] = sum + queries_[k];
  }
}

PartitionKind PartitionCosts::cheapest() const noexcept {
  const auto least = std::min_element(total_.begin(), total_.end());
  return static_cast<PartitionKind>(least - total_.begin());
}

std::string_view partition_name(PartitionKind kind) noexcept {
  return kConstants[static_cast<std::size_t>(kind)].name;
}

}  // namespace winnow
