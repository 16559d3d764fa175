// Races bounding volumes (boxes, spheres, k-DOPs, boxes with margins) around the same oriented
// boxes through broad and narrow phase. bench/rows/volume_rows.cpp calls it.

#include "bench/measure/volume_race.h"

#include <winnow/core/kdop_around.h>
#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/contenders/partitions.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>

namespace winnow::bench {

namespace {

/// One kind of volume with its own partition.
class Contestant {
 public:
  template <typename V>
  Contestant(std::string name, const VolumeRaceOptions& race, V (*maker)(const OrientedBox&),
             Volume volume, float margin = 0.0F)
      : partition_(make_named(
            race.partition,
            {.execution = Execution::serial(), .volume = volume, .fat_margin = {.share = margin}})),
        margin_(margin) {
    row.volume = std::move(name);
    const auto volumes = std::make_shared<std::vector<V>>();
    make_ = [=](const std::vector<OrientedBox>& boxes) {
      volumes->resize(boxes.size());
      for (std::size_t i = 0; i < boxes.size(); ++i) (*volumes)[i] = maker(boxes[i]);
    };
    put_ = [=](Partition& partition, std::vector<Key>& keys) {
      const std::span<const V> all(*volumes);
      if (!keys.empty()) return partition.update(keys, all);
      keys.resize(all.size());
      return partition.insert(all, {}, keys);
    };
  }

  /// Inserts the volumes, before the first frame.
  void begin(const Solids& solids) {
    make_(solids.boxes_at_last_refit(margin_));
    need(put_(partition_, keys_), "volumes");
  }
  /// Runs one frame.
  void run(const Solids& solids, NarrowPhase& narrow, NarrowResult& result, bool timed);
  /// Counts the overlapping pairs that this volume missed; `truth` is the union over all volumes.
  void judge(const std::vector<std::uint64_t>& truth, bool counted);

  VolumeRow row;
  std::vector<std::uint64_t> overlapping;  // of the last frame: first << 32 | second, sorted

 private:
  std::function<void(const std::vector<OrientedBox>&)> make_;
  std::function<Status(Partition&, std::vector<Key>&)> put_;
  Partition partition_;
  float margin_;
  std::vector<Key> keys_;
  PairBuffer pairs_;
};

void Contestant::run(const Solids& solids, NarrowPhase& narrow, NarrowResult& result, bool timed) {
  const ThreadStopwatch make_clock;
  make_(solids.boxes());
  const double make_ms = make_clock.ms();
  const ThreadStopwatch broad_clock;
  need(put_(partition_, keys_), "volumes");
  need(partition_.self_pairs(pairs_), "pairs");
  const double broad_ms = broad_clock.ms();
  // Keys are given in order, so ids are the indices of the objects.
  std::vector<BodyPair> candidates;
  candidates.reserve(pairs_.size());
  for (const Pair& pair : pairs_) candidates.push_back({pair.first, pair.second});
  const ThreadStopwatch narrow_clock;
  need(narrow.collide(solids.shapes(), solids.bodies(), candidates,
                      {.level = ContactLevel::boolean}, result),
       "pairs");
  const double narrow_ms = narrow_clock.ms();
  overlapping.clear();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!result.overlaps(i)) continue;
    const BodyPair& pair = candidates[result.pair_of(i)];
    overlapping.push_back(std::uint64_t{std::min(pair.a, pair.b)} << 32U |
                          std::max(pair.a, pair.b));
  }
  std::sort(overlapping.begin(), overlapping.end());
  if (!timed) return;
  row.make.push_back(make_ms);
  row.broad.push_back(broad_ms);
  row.narrow.push_back(narrow_ms);
  row.reported += candidates.size();
  const Footprint bytes = partition_.footprint();
  row.bytes_per_object =
      static_cast<double>(bytes.total().reserved) / static_cast<double>(solids.size());
}

void Contestant::judge(const std::vector<std::uint64_t>& truth, bool counted) {
  if (!counted) return;
  row.overlapping += overlapping.size();
  for (const std::uint64_t pair : overlapping) row.fingerprint += mix(pair);
  row.missed += truth.size() - overlapping.size();
}

// Rounds like kdop_around, so that volumes are compared and not their rounding.
Aabb box_of(const OrientedBox& box) {
  Aabb result;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto center = static_cast<double>(box.center[axis]);
    double reach = 4e-15 * std::abs(center);
    for (Eigen::Index i = 0; i < 3; ++i) {
      reach += std::abs(static_cast<double>(box.axes(axis, i))) * static_cast<double>(box.half[i]) *
               (1.0 + 4e-15);
    }
    const auto low = static_cast<float>(center - reach);
    const auto high = static_cast<float>(center + reach);
    result.min[axis] = low - std::abs(low) * 1.2e-7F;
    result.max[axis] = high + std::abs(high) * 1.2e-7F;
  }
  return result;
}

Sphere sphere_of(const OrientedBox& box) {
  return {box.center, round_up(box.half.cast<double>().norm() * (1.0 + 1e-6))};
}

std::vector<Contestant> all_contestants(const VolumeRaceOptions& race) {
  std::vector<Contestant> all;
  all.emplace_back("AABB", race, box_of, Volume::aabb);
  all.emplace_back("sphere", race, sphere_of, Volume::sphere);
  all.emplace_back("14-DOP", race, kdop_around<14>, Volume::kdop14);
  all.emplace_back("18-DOP", race, kdop_around<18>, Volume::kdop18);
  all.emplace_back("26-DOP", race, kdop_around<26>, Volume::kdop26);
  for (const int percent : {5, 10, 20, 50}) {
    all.emplace_back("AABB + " + std::to_string(percent) + " %", race, box_of, Volume::aabb,
                     0.01F * static_cast<float>(percent));
  }
  return all;
}

}  // namespace

double VolumeRow::false_positives() const noexcept {
  if (reported == 0) return 0.0;
  return 1.0 - static_cast<double>(overlapping) / static_cast<double>(reported);
}

std::vector<double> VolumeRow::found() const {
  std::vector<double> ms = make;
  for (std::size_t i = 0; i < ms.size(); ++i) ms[i] += broad[i];
  return ms;
}

std::vector<double> VolumeRow::answered() const {
  std::vector<double> ms = found();
  for (std::size_t i = 0; i < ms.size(); ++i) ms[i] += narrow[i];
  return ms;
}

std::vector<VolumeRow> race_volumes(Solids solids, const VolumeRaceOptions& options) {
  std::vector<Contestant> all = all_contestants(options);
  for (Contestant& one : all) one.begin(solids);
  NarrowPhase narrow;
  NarrowResult result;
  for (std::size_t frame = 0; frame <= options.frames; ++frame) {
    const bool timed = frame != 0;
    std::vector<std::uint64_t> truth;
    for (Contestant& one : all) {
      one.run(solids, narrow, result, timed);
      std::vector<std::uint64_t> both;
      std::set_union(truth.begin(), truth.end(), one.overlapping.begin(), one.overlapping.end(),
                     std::back_inserter(both));
      truth.swap(both);
    }
    for (Contestant& one : all) one.judge(truth, timed);
    if (options.recorded.empty()) {
      solids.advance(options.step);
    } else {
      solids.follow(options.recorded[std::min(frame + 1, options.recorded.size() - 1)]);
    }
  }
  std::vector<VolumeRow> rows;
  for (Contestant& one : all) rows.push_back(std::move(one.row));
  return rows;
}

double pays_from_ns(const VolumeRow& row, const VolumeRow& boxes) {
  if (row.reported >= boxes.reported) return 0.0;
  const auto frames = static_cast<double>(boxes.make.size());
  const double saved = static_cast<double>(boxes.reported - row.reported) / frames;
  const double more = row.make_ms() + row.broad_ms() - boxes.make_ms() - boxes.broad_ms();
  return std::max(0.0, 1e6 * more / saved);
}

namespace {

constexpr std::array<std::string_view, 4> kVolumeSettings{"scene", "cubes", "rods", "slow"};
constexpr std::array<std::string_view, 8> kVolumePartitions{
    "BoundsNSquared", "SweepAndPrune", "FlatGrid",  "HierarchicalGrid",
    "LooseOctree",    "LooseQuadtree", "LinearBvh", "StaticBvh"};

// A fast and a slow movement per frame, in mean edges; fat margins are useful for the slow one.
constexpr double kFast = 0.1;
constexpr double kSlow = 0.002;

constexpr std::size_t kWatchedFrames = 20;

/// Mean movement of the objects per frame, in mean edges; 0 if it cannot be computed.
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
