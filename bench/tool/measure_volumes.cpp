#include "tool/measure_volumes.h"

#include "tool/arguments.h"

#include <algorithm>
#include <array>

namespace winnow::bench {
namespace {

constexpr std::array<std::string_view, 4> kVolumeSettings{"scene", "cubes", "rods", "slow"};
constexpr std::array<std::string_view, 8> kVolumePartitions{
    "BoundsNSquared", "SweepAndPrune", "FlatGrid",  "HierarchicalGrid",
    "LooseOctree",    "LooseQuadtree", "LinearBvh", "StaticBvh"};

// A fast and a slow way to move: margins are for the latter.
constexpr double kFast = 0.1;
constexpr double kSlow = 0.002;

constexpr std::size_t kWatchedFrames = 20;

/// Mean way of the objects from one frame to the next, in mean edges; 0 if nothing can be told.
double step_of(const Recording& recording) {
  const auto& frames = recording.frames;
  double way = 0.0;
  double edges = 0.0;
  for (std::size_t f = 0; f + 1 < std::min(frames.size(), kWatchedFrames); ++f) {
    for (std::size_t i = 0; i < frames[f].size(); ++i) {
      const Aabb& from = frames[f][i];
      const Aabb& to = frames[f + 1][i];
      const Eigen::Vector3f moved = 0.5F * (to.min - from.min + to.max - from.max);
      const Eigen::Vector3f extent = from.max - from.min;
      if (!moved.allFinite() || !extent.allFinite()) continue;
      way += static_cast<double>(moved.norm());
      edges += static_cast<double>(extent.mean());
    }
  }
  return edges > 0.0 ? way / edges : 0.0;
}

}  // namespace

std::span<const std::string_view> volume_setting_names() noexcept {
  return kVolumeSettings;
}

std::span<const std::string_view> volume_partitions() noexcept {
  return kVolumePartitions;
}

VolumeSetting make_volume_setting(std::string_view name, const VolumeSettingOptions& options) {
  const auto& [scene, recording, objects, seed] = options;
  if (name == "cubes") return {"rotated cubes", kFast, Solids::rotated(objects, seed)};
  if (name == "rods") return {"rotated rods 1:1:20", kFast, Solids::rods(objects, seed)};
  if (name == "slow") return {"rotated cubes, slow", kSlow, Solids::rotated(objects, seed)};
  if (recording != nullptr) {
    return {recording->scene, step_of(*recording), Solids::of_boxes(recording->frames.front()),
            recording->frames};
  }
  return {scene, kFast, Solids::of_boxes(scene_or_error(scene, objects, seed)->boxes())};
}

std::size_t volume_frames(std::size_t objects) noexcept {
  if (objects <= 20'000) return 15;
  return objects <= 200'000 ? 7 : 3;
}

}  // namespace winnow::bench
