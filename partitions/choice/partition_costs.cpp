#include "partitions/choice/partition_costs.h"

#include <algorithm>
#include <bit>

namespace winnow {
namespace {

/// See PartitionCosts. Nanoseconds.
struct Constants {
  std::string_view name;
  double frame, keep;
  double object, level, crowd, square, pair;
  double moved, rest;
  double build, build_level;
  double ask, ask_level, scan, rows;
};

constexpr double kNearest = 4.0;  // times what a ray or box costs

constexpr std::array<Constants, kPartitionKinds> kConstants{{
    {"BoundsNSquared", 480, 7, 11, 0, 0, 0.103, 4.1, 130, 2.0, 5, 0, 120, 0, 0.75, 0},
    {"SweepAndPrune", 640, 11, 10.1, 0.05, 5.5, 0, 5.0, 200, 1.4, 110, 0, 0, 32, 0, 1.5},
    {"FlatGrid", 640, 15, 7.5, 0, 6.3, 0, 7.4, 190, 1.3, 60, 0, 0, 36, 0, 1.5},
    {"HierarchicalGrid", 2160, 15, 0, 0.14, 2.4, 0, 4.9, 190, 1.0, 150, 0, 40, 24, 0, 1.0},
    {"LinearBvh", 760, 10, 1.65, 0.47, 1.6, 0, 5.3, 75, 1.4, 38, 10, 50, 20, 0, 0},
    {"StaticBvh", 640, 10, 5.7, 0.16, 1.9, 0, 5.6, 75, 1.3, 244, 43, 80, 13, 0, 0},
}};

}  // namespace

PartitionCosts::PartitionCosts(const SceneFeatures& scene, const FrameWork& frame,
                               double pairs) noexcept {
  const auto n = static_cast<double>(scene.objects);
  const auto changed = static_cast<double>(std::min(frame.changed, scene.objects));
  const auto level = static_cast<double>(std::bit_width(scene.objects));
  // Past a quarter of the objects partitions follow no single changes.
  const bool much = 4.0 * changed > n;
  const auto queries = static_cast<double>(frame.pair_queries);
  const double full = much ? queries : static_cast<double>(frame.full_queries);
  const double partial = queries - full;
  const double redone = full * pairs + partial * pairs * changed / std::max(n, 1.0);
  const auto others = static_cast<double>(frame.casts + frame.regions) +
                      kNearest * static_cast<double>(frame.nearest);
  for (std::size_t k = 0; k < kPartitionKinds; ++k) {
    const Constants& c = kConstants[k];
    const double meets = c.level * level + c.square * n;
    const double all = c.object + meets + c.crowd * scene.crowding;
    total_[k] = full * n * all + partial * (changed * (c.moved + meets) + c.rest * n);
    total_[k] += c.frame + c.keep * changed + c.pair * redone;
    queries_[k] = others * (c.ask + c.ask_level * level + c.scan * n);
    if (others > 0.0) queries_[k] += c.rows * changed;
    total_[k] += queries_[k];
    build_[k] = n * (c.build + c.build_level * level);
  }
}

PartitionKind PartitionCosts::cheapest(double frames) const noexcept {
  std::size_t best = 0;
  for (std::size_t k = 1; k < kPartitionKinds; ++k) {
    if (build_[k] + frames * total_[k] < build_[best] + frames * total_[best]) best = k;
  }
  return static_cast<PartitionKind>(best);
}

std::string_view partition_name(PartitionKind kind) noexcept {
  return kConstants[static_cast<std::size_t>(kind)].name;
}

}  // namespace winnow
