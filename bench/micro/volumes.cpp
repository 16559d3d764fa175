// Benchmarks of bounding volumes (boxes, spheres, k-DOPs, boxes with margins) around the same
// oriented boxes. An iteration is a frame: volumes are made, the partition finds pairs, and an
// exact test selects those that overlap.

#include "bench/micro/micro.h"

#include <winnow/core/regions.h>
#include "bench/common/need.h"
#include "bench/common/sample.h"
#include "bench/contenders/partitions.h"
#include "bench/scenes/solids.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace winnow::bench::micro {
namespace {

constexpr std::size_t kObjects = 10'000;
constexpr const char* kPartition = "LinearBvh";  ///< in which all volumes are compared

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

/// A kind of volume: makes the volumes of all boxes, and writes them to a partition.
struct VolumeKind {
  std::string name;
  Volume volume{};
  float margin = 0.0F;  ///< of fat boxes, as a share of the longest edge
  /// Returns a function that makes the volumes, and one that inserts or updates them.
  struct Functions {
    std::function<void(const std::vector<OrientedBox>&)> make;
    std::function<Status(Partition&, std::vector<Key>&)> put;
  };
  Functions (*functions)();
};

template <typename V, V (*Maker)(const OrientedBox&)>
VolumeKind::Functions functions_of() {
  const auto volumes = std::make_shared<std::vector<V>>();
  return {[=](const std::vector<OrientedBox>& boxes) {
            volumes->resize(boxes.size());
            std::ranges::transform(boxes, volumes->begin(), Maker);
          },
          [=](Partition& partition, std::vector<Key>& keys) {
            const std::span<const V> all(*volumes);
            if (!keys.empty()) return partition.update(keys, all);
            keys.resize(all.size());
            return partition.insert(all, {}, keys);
          }};
}

std::vector<VolumeKind> volume_kinds() {
  std::vector<VolumeKind> all{
      {"aabb", Volume::aabb, 0.0F, functions_of<Aabb, box_of>},
      {"sphere", Volume::sphere, 0.0F, functions_of<Sphere, sphere_of>},
      {"14-dop", Volume::kdop14, 0.0F, functions_of<Kdop<14>, kdop_around<14>>},
      {"18-dop", Volume::kdop18, 0.0F, functions_of<Kdop<18>, kdop_around<18>>},
      {"26-dop", Volume::kdop26, 0.0F, functions_of<Kdop<26>, kdop_around<26>>}};
  for (const int percent : {5, 10, 20, 50}) {
    all.push_back({"aabb_plus_" + std::to_string(percent) + "_percent", Volume::aabb,
                   0.01F * static_cast<float>(percent), functions_of<Aabb, box_of>});
  }
  return all;
}

/// Objects and their movement per frame, in mean edges.
struct VolumeSetting {
  std::string name;
  double step;
  std::function<Solids()> make;
};

/// The volumes of one kind around moving solids.
class VolumeFrames {
 public:
  VolumeFrames(const VolumeKind& kind, const std::string& structure, const VolumeSetting& setting)
      : solids_(setting.make()),
        step_(setting.step),
        functions_(kind.functions()),
        partition_(make_named(structure, {.execution = Execution::serial(),
                                          .volume = kind.volume,
                                          .fat_margin = {.share = kind.margin}})) {
    functions_.make(solids_.boxes_at_last_refit(kind.margin));
    need(functions_.put(partition_, keys_), "volumes");
    frame();
    check(overlapping() == truth(), "pairs that overlap were missed");
    make_ms = broad_ms = narrow_ms = {};
    reported = overlaps = 0;
  }

  /// Runs one frame and returns its seconds.
  double frame() {
    solids_.advance(step_);
    const ThreadStopwatch make_clock;
    functions_.make(solids_.boxes());
    make_ms.push_back(make_clock.ms());
    const ThreadStopwatch broad_clock;
    need(functions_.put(partition_, keys_), "volumes");
    need(partition_.self_pairs(pairs_), "pairs");
    broad_ms.push_back(broad_clock.ms());
    // Keys are given in order, so ids are the indices of the objects.
    candidates_.clear();
    for (const Pair& pair : pairs_) candidates_.push_back({pair.first, pair.second});
    const ThreadStopwatch narrow_clock;
    test(candidates_);
    narrow_ms.push_back(narrow_clock.ms());
    reported += candidates_.size();
    overlaps += overlapping();
    return 1e-3 * (make_ms.back() + broad_ms.back() + narrow_ms.back());
  }

  [[nodiscard]] double bytes_per_object() const {
    return static_cast<double>(partition_.footprint().total().reserved) /
           static_cast<double>(solids_.size());
  }

  // Milliseconds by frame, and sums over the frames.
  std::vector<double> make_ms;
  std::vector<double> broad_ms;
  std::vector<double> narrow_ms;
  std::size_t reported = 0;
  std::size_t overlaps = 0;

 private:
  void test(const std::vector<BodyPair>& pairs) {
    need(narrow_.collide(solids_.shapes(), solids_.bodies(), pairs,
                         {.level = ContactLevel::boolean}, result_),
         "pairs");
  }
  /// Returns the number of overlapping pairs of the last test.
  [[nodiscard]] std::size_t overlapping() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < result_.size(); ++i) count += result_.overlaps(i) ? 1 : 0;
    return count;
  }
  /// Returns the number of overlapping pairs, found by testing all boxes.
  [[nodiscard]] std::size_t truth() {
    const std::vector<Aabb> bounds = solids_.bounds();
    Partition all = make_named("BoundsNSquared");
    std::vector<Key> keys(bounds.size());
    need(all.insert(bounds, {}, keys), "objects");
    PairBuffer pairs;
    need(all.self_pairs(pairs), "pairs");
    std::vector<BodyPair> candidates;
    for (const Pair& pair : pairs) candidates.push_back({pair.first, pair.second});
    test(candidates);
    return overlapping();
  }

  Solids solids_;
  double step_;
  VolumeKind::Functions functions_;
  Partition partition_;
  std::vector<Key> keys_;
  PairBuffer pairs_;
  std::vector<BodyPair> candidates_;
  NarrowPhase narrow_;
  NarrowResult result_;
};

void add_volume(const VolumeSetting& setting, std::size_t objects, const std::string& structure,
                const VolumeKind& kind) {
  const std::string path = "volume/" + setting.name + "/step:" + key_text(setting.step) +
                           "/objects:" + std::to_string(objects) + "/" + word_of(structure) + "/" +
                           kind.name;
  add(path, [=](benchmark::State& state) {
    auto& frames = prepared<VolumeFrames>(path, kind, structure, setting);
    run(state, 1, [&] { state.SetIterationTime(frames.frame()); });
    const auto all = static_cast<double>(frames.make_ms.size());
    const double reported = std::max(1.0, static_cast<double>(frames.reported));
    count(state, "make_ms", median_of(frames.make_ms));
    count(state, "broad_ms", median_of(frames.broad_ms));
    count(state, "narrow_ms", median_of(frames.narrow_ms));
    count(state, "reported", reported / all);
    count(state, "overlapping", static_cast<double>(frames.overlaps) / all);
    count(state, "false_positives", 1.0 - static_cast<double>(frames.overlaps) / reported);
    count(state, "bytes_per_object", frames.bytes_per_object());
  })->UseManualTime();
}

/// Returns the scenes without rotation, and rotated objects.
std::vector<VolumeSetting> volume_settings(const std::vector<NamedScene>& scenes) {
  // A fast and a slow movement per frame, in mean edges; fat margins are useful for the slow one.
  constexpr double kFast = 0.1;
  constexpr double kSlow = 0.002;
  const auto cubes = [] { return Solids::rotated(kObjects, 1); };
  std::vector<VolumeSetting> settings{{"cubes", kFast, cubes},
                                      {"rods", kFast, [] { return Solids::rods(kObjects, 1); }},
                                      {"slow", kSlow, cubes}};
  for (const NamedScene& scene : scenes) {
    settings.push_back({word_of(scene.name), kFast, [scene] {
                          const auto source = scene.source(scene.objects(kObjects), 1);
                          return Solids::of_boxes(source->boxes());
                        }});
  }
  return settings;
}

}  // namespace

void add_volumes(const std::vector<NamedScene>& scenes) {
  const std::vector<VolumeSetting> settings = volume_settings(scenes);
  for (const VolumeKind& kind : volume_kinds()) {
    for (const VolumeSetting& setting : settings) add_volume(setting, kObjects, kPartition, kind);
    for (const char* structure : {"SweepAndPrune", "FlatGrid", "HierarchicalGrid", "LooseOctree",
                                  "LooseQuadtree", "StaticBvh"}) {
      add_volume(settings.front(), kObjects, structure, kind);
    }
    // Distances an object moves in a frame, in edge lengths, at which margins are compared; the
    // greatest is that of `cubes`.
    for (const double step : {0.001, 0.003, 0.01, 0.03}) {
      if (kind.volume != Volume::aabb) continue;
      add_volume({"cubes", step, settings.front().make}, kObjects, kPartition, kind);
    }
  }
}

}  // namespace winnow::bench::micro
