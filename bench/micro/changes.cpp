// Benchmarks of partitions over time: after many removals and insertions, with pair events if only
// a share of the objects moves, and with many environments beside as many partitions.

#include "bench/micro/micro.h"

#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/common/sample.h"
#include "bench/contenders/partitions.h"
#include "bench/measure/race.h"
#include "bench/scenes/query_set.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <numeric>

namespace winnow::bench::micro {
namespace {

constexpr std::array kStructures{"LinearBvh", "FlatGrid", "SweepAndPrune"};
constexpr std::size_t kObjects = 100'000;
constexpr std::size_t kReplacements = 5'000'000;
constexpr std::size_t kRays = 20'000;
constexpr std::size_t kWorlds = 1'000;
constexpr std::size_t kWorldObjects = 100;

std::vector<Aabb> uniform_boxes() {
  const auto scene = make_scene("uniform", kObjects, 1);
  return {scene->boxes().begin(), scene->boxes().end()};
}

/// A partition with the keys of its objects and its pairs.
struct FilledPartition {
  Partition partition;
  std::vector<Key> keys;
  PairBuffer pairs{};
  PairEvents events{};

  FilledPartition(const std::string& structure, std::span<const Aabb> boxes)
      : partition(make_named(structure, {.execution = Execution::serial()})), keys(boxes.size()) {
    need(partition.insert(boxes, {}, keys), "objects");
  }
  void frame(std::span<const Aabb> boxes) {
    need(partition.update(keys, boxes), "objects");
    need(partition.self_pairs(pairs), "pairs");
  }
};

/// A partition whose objects were replaced many times, and a new one with equal boxes.
struct Churned {
  std::vector<Aabb> boxes = uniform_boxes();
  FilledPartition worn;
  FilledPartition fresh;
  std::vector<Ray> rays;

  explicit Churned(const std::string& structure)
      : worn(structure, boxes), fresh(structure, replace_objects()) {
    rays = make_query_set("closest_ray", boxes, kRays, 1).rays;
    for (FilledPartition* const one : {&worn, &fresh}) {
      need(one->partition.self_pairs(one->pairs, {.incremental = false}), "pairs");
    }
    check(worn.pairs.size() == fresh.pairs.size(), "other pairs were found");
  }

 private:
  /// Replaces random objects one by one; finds pairs each time a tenth of them was replaced.
  std::span<const Aabb> replace_objects() {
    const Aabb world = world_of(boxes);
    Random random(3);
    for (std::size_t done = 0; done < kReplacements; ++done) {
      const std::uint32_t i = random.below(static_cast<std::uint32_t>(kObjects));
      const Vec3f edges = boxes[i].max - boxes[i].min;
      const Vec3d highest = (world.max - edges).cast<double>();
      boxes[i].min = random.in(world.min.cast<double>(), highest).cast<float>();
      boxes[i].max = boxes[i].min + edges;
      need(worn.partition.remove(worn.keys[i]), "objects");
      worn.keys[i] = need(worn.partition.insert(boxes[i], i), "objects");
      if ((done + 1) % (kObjects / 10) == 0) need(worn.partition.self_pairs(worn.pairs), "pairs");
    }
    return boxes;
  }
};

void add_churn(const std::string& structure, FilledPartition Churned::*one, const char* age) {
  const auto prepared_churn = [structure]() -> Churned& {
    return prepared<Churned>("churn " + structure, structure);
  };
  const std::string path =
      std::string("/") + age + "/objects:" + std::to_string(kObjects) + "/" + word_of(structure);
  add("churn/self_pairs" + path, [=](benchmark::State& state) {
    FilledPartition& filled = prepared_churn().*one;
    run(state, 1,
        [&] { need(filled.partition.self_pairs(filled.pairs, {.incremental = false}), "pairs"); });
    const Footprint footprint = filled.partition.footprint();
    count(state, "bytes_per_object", footprint.total().reserved - footprint.results.reserved,
          kObjects);
  });
  add("churn/closest_ray" + path, [=](benchmark::State& state) {
    const Churned& churned = prepared_churn();
    run(state, 1, [&] {
      for (const Ray& ray : churned.rays) need((churned.*one).partition.closest(ray), "rays");
    });
    count_ns(state, "ns_per_query", kRays);
  });
}

/// Boxes of which a random share moves a little in each frame.
class MovingShare {
 public:
  MovingShare(const std::string& structure, double share)
      : boxes_(uniform_boxes()),
        filled_(structure, boxes_),
        order_(kObjects),
        moving_(static_cast<std::size_t>(share * static_cast<double>(kObjects))) {
    std::iota(order_.begin(), order_.end(), 0U);
    for (std::size_t settling = 0; settling < kSettlingFrames; ++settling) (void)frame();
  }

  /// Moves a share and returns the seconds of the update and of the search for events.
  double frame() {
    keys_.clear();
    moved_.clear();
    random_.draw_front(order_, moving_);
    for (const std::uint32_t i : std::span(order_).first(moving_)) {
      const Vec3f by = random_.in_cube(-0.05, 0.05).cast<float>();
      boxes_[i] = {boxes_[i].min + by, boxes_[i].max + by};
      keys_.push_back(filled_.keys[i]);
      moved_.push_back(boxes_[i]);
    }
    const ThreadStopwatch clock;
    if (moving_ != 0) need(filled_.partition.update(keys_, moved_), "objects");
    need(filled_.partition.self_pairs(filled_.pairs, filled_.events), "pairs");
    return 1e-3 * clock.ms();
  }

 private:
  std::vector<Aabb> boxes_;
  FilledPartition filled_;
  std::vector<std::uint32_t> order_;
  std::size_t moving_;
  std::vector<Key> keys_;
  std::vector<Aabb> moved_;
  Random random_{4};
};

void add_events(const std::string& structure, double share) {
  const std::string of_structure =
      "/objects:" + std::to_string(kObjects) + "/" + word_of(structure);
  const std::string path = "events/moving:" + key_text(share) + of_structure;
  add(path, [=](benchmark::State& state) {
    auto& moving = prepared<MovingShare>(path, structure, share);
    run(state, 1, [&] { state.SetIterationTime(moving.frame()); });
  })->UseManualTime();
}

/// Many small scenes at one place: environments of one partition, and a partition for each.
struct Worlds {
  std::vector<std::unique_ptr<FrameSource>> scenes;
  std::vector<Aabb> boxes;
  std::vector<FilledPartition> together;  ///< one
  std::vector<FilledPartition> apart;

  explicit Worlds(const std::string& structure) {
    std::vector<ObjectFilter> filters(kWorlds * kWorldObjects);
    for (std::size_t w = 0; w < kWorlds; ++w) {
      scenes.push_back(make_scene("uniform", kWorldObjects, w + 1));
      apart.emplace_back(structure, scenes.back()->boxes());
      for (std::size_t i = 0; i < kWorldObjects; ++i) {
        filters[w * kWorldObjects + i].environment = static_cast<std::uint32_t>(w);
      }
    }
    advance();
    together.emplace_back(structure, boxes);
    need(together[0].partition.set_filter(together[0].keys, filters), "objects");
    std::size_t pairs = 0;
    frame(together);
    frame(apart);
    for (const FilledPartition& world : apart) pairs += world.pairs.size();
    check(pairs == together[0].pairs.size(), "other pairs were found");
  }
  void advance() {
    boxes.clear();
    for (const auto& scene : scenes) {
      scene->advance();
      boxes.insert(boxes.end(), scene->boxes().begin(), scene->boxes().end());
    }
  }
  void frame(std::vector<FilledPartition>& partitions) const {
    const std::size_t each = boxes.size() / partitions.size();
    for (std::size_t w = 0; w < partitions.size(); ++w) {
      partitions[w].frame(std::span(boxes).subspan(w * each, each));
    }
  }
};

void add_worlds(const std::string& structure, std::vector<FilledPartition> Worlds::*how,
                const char* name) {
  const std::string path = std::string("worlds/") + name + "/worlds:" + std::to_string(kWorlds) +
                           "/objects:" + std::to_string(kWorldObjects) + "/" + word_of(structure);
  add(path, [=](benchmark::State& state) {
    auto& worlds = prepared<Worlds>("worlds " + structure, structure);
    run(state, 1, [&] {
      state.PauseTiming();
      worlds.advance();
      state.ResumeTiming();
      worlds.frame(worlds.*how);
    });
    count_ns(state, "ns_per_object", worlds.boxes.size());
  });
}

}  // namespace

void add_changes() {
  for (const char* const structure : kStructures) {
    add_churn(structure, &Churned::worn, "worn");
    add_churn(structure, &Churned::fresh, "fresh");
    for (const double share : {0.0, 0.01, 0.1, 1.0}) add_events(structure, share);
    add_worlds(structure, &Worlds::together, "together");
    add_worlds(structure, &Worlds::apart, "apart");
  }
}

}  // namespace winnow::bench::micro
