// Measures how a partition's costs change over time: after many removals and insertions, with pair
// events, in quiet frames, and with many environments. goals/measurements.cpp calls it.

#include "bench/measure/partition_costs.h"

#include "bench/common/interleaved_runs.h"
#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/common/sample.h"
#include "bench/contenders/partition_engine.h"
#include "bench/scenes/cameras.h"
#include "bench/scenes/query_set.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <stdexcept>

namespace winnow::bench {
namespace {

constexpr std::size_t kRounds = 9;
/// Untimed rounds before the timed ones, in which all buffers reach their sizes.
constexpr std::size_t kSizingRounds = 2;

template <typename Work>
double thread_ms(Work&& work) {
  const ThreadStopwatch clock;
  work();
  return clock.ms();
}

double bytes_of(const Partition& partition) {
  const Footprint footprint = partition.footprint();
  return static_cast<double>(footprint.total().reserved - footprint.results.reserved);
}

/// Replaces `replacements` times a random object; finds pairs each time a tenth of the objects has
/// been replaced.
void churn(Partition& partition, std::vector<Key>& keys, std::vector<Aabb>& boxes,
           std::size_t replacements, PairBuffer& pairs) {
  const Aabb world = world_of(boxes);
  const std::size_t frame = std::max<std::size_t>(1, boxes.size() / 10);
  Random random(3);
  for (std::size_t done = 0; done < replacements; ++done) {
    const std::uint32_t i = random.below(static_cast<std::uint32_t>(boxes.size()));
    const Eigen::Vector3f edges = boxes[i].max - boxes[i].min;
    for (int axis = 0; axis < 3; ++axis) {
      boxes[i].min[axis] = static_cast<float>(
          random.in(static_cast<double>(world.min[axis]),
                    static_cast<double>(world.max[axis]) - static_cast<double>(edges[axis])));
    }
    boxes[i].max = boxes[i].min + edges;
    need(partition.remove(keys[i]), "objects");
    need(partition.insert(boxes[i], i, keys[i]), "objects");
    if ((done + 1) % frame == 0) need(partition.self_pairs(pairs), "pairs");
  }
}

/// Frames of a scene in which a random share of the objects moves.
class MovingObjects {
 public:
  explicit MovingObjects(std::size_t objects)
      : scene_(make_scene("uniform", objects, 1)), order_(objects) {
    std::iota(order_.begin(), order_.end(), 0U);
  }

  [[nodiscard]] std::span<const Aabb> boxes() const { return scene_->boxes(); }

  /// Goes to the next frame and returns keys and boxes of a random share of the objects.
  void advance(double share, std::span<const Key> keys, std::vector<Key>& moved,
               std::vector<Aabb>& moved_boxes) {
    scene_->advance();
    const auto count = static_cast<std::size_t>(share * static_cast<double>(order_.size()));
    moved.clear();
    moved_boxes.clear();
    for (std::size_t i = 0; i < count; ++i) {
      if (count != order_.size()) {
        const auto rest = static_cast<std::uint32_t>(order_.size() - i);
        std::swap(order_[i], order_[i + random_.below(rest)]);
      }
      moved.push_back(keys[order_[i]]);
      moved_boxes.push_back(boxes()[order_[i]]);
    }
  }

 private:
  std::unique_ptr<FrameSource> scene_;
  std::vector<std::uint32_t> order_;
  Random random_{4};
};

/// Many small scenes at the same position; the boxes of a frame are in one array.
class Worlds {
 public:
  Worlds(std::size_t worlds, std::size_t objects_each) {
    for (std::size_t w = 0; w < worlds; ++w) {
      scenes_.push_back(make_scene("uniform", objects_each, w + 1));
    }
    gather();
  }

  [[nodiscard]] const std::vector<Aabb>& boxes() const noexcept { return boxes_; }
  void advance() {
    for (auto& scene : scenes_) scene->advance();
    gather();
  }

 private:
  void gather() {
    boxes_.clear();
    for (const auto& scene : scenes_) {
      boxes_.insert(boxes_.end(), scene->boxes().begin(), scene->boxes().end());
    }
  }

  std::vector<std::unique_ptr<FrameSource>> scenes_;
  std::vector<Aabb> boxes_;
};

/// A partition with the keys of its objects and its pairs.
struct FilledPartition {
  Partition partition;
  std::vector<Key> keys;
  PairBuffer pairs;

  FilledPartition(std::string_view name, std::span<const Aabb> boxes)
      : partition(make_named(name, {.execution = Execution::serial()})), keys(boxes.size()) {
    need(partition.insert(boxes, {}, keys), "objects");
  }
  void frame(std::span<const Aabb> boxes) {
    need(partition.update(keys, boxes), "objects");
    need(partition.self_pairs(pairs), "pairs");
  }
};

}  // namespace

std::vector<std::pair<std::string_view, double>> measure_churn(std::string_view partition,
                                                               std::size_t objects,
                                                               std::size_t operations) {
  const auto scene = make_scene("uniform", objects, 1);
  std::vector<Aabb> boxes(scene->boxes().begin(), scene->boxes().end());
  FilledPartition worn(partition, boxes);
  churn(worn.partition, worn.keys, boxes, operations / 2, worn.pairs);
  FilledPartition fresh(partition, boxes);
  const std::vector<std::string> names{"ray closest"};
  const std::vector<Ray> rays = make_query_sets(boxes, 20'000, 1, names).front().rays;

  const auto pairs_of = [](FilledPartition& one) {
    return [&one] { need(one.partition.self_pairs(one.pairs, {.incremental = false}), "pairs"); };
  };
  const auto rays_of = [&](FilledPartition& one) {
    return [&] {
      Hit hit;
      for (const Ray& ray : rays) need(one.partition.closest(ray, hit), "rays");
    };
  };
  // Median of the ratios of each round, whose two measurements are close in time.
  const auto ratio = [&](const auto& work_of) {
    const auto ms = run_interleaved(2, kRounds, 0, [&](std::size_t, std::size_t i) {
      const auto work = work_of(i == 0 ? worn : fresh);
      work();  // warms it up
      return thread_ms(work);
    });
    std::vector<double> ratios;
    for (std::size_t r = 0; r < kRounds; ++r) ratios.push_back(ms[0][r] / ms[1][r]);
    return median_of(ratios);
  };
  return {{"self pairs", ratio(pairs_of)},
          {"rays", ratio(rays_of)},
          {"bytes", bytes_of(worn.partition) / bytes_of(fresh.partition)}};
}

std::vector<std::vector<double>> measure_event_frames(std::string_view partition,
                                                      std::size_t objects,
                                                      const std::vector<double>& shares) {
  MovingObjects moving(objects);
  FilledPartition one(partition, moving.boxes());
  PairEvents events;
  std::vector<Key> moved;
  std::vector<Aabb> boxes;
  return run_interleaved(shares.size(), kRounds, kSizingRounds, [&](std::size_t, std::size_t i) {
    moving.advance(shares[i], one.keys, moved, boxes);
    return thread_ms([&] {
      if (!moved.empty()) need(one.partition.update(moved, boxes), "objects");
      need(one.partition.self_pairs(one.pairs, events), "pairs");
    });
  });
}

std::vector<double> measure_quiet_frames(std::string_view partition, std::string_view scene,
                                         std::size_t objects, std::size_t frames) {
  const auto source = scene_or_error(std::string(scene), objects, 1);
  const std::vector<Aabb> before(source->boxes().begin(), source->boxes().end());
  PartitionEngine engine(partition, 1);
  engine.start(before);
  source->advance();
  std::vector<std::uint32_t> moving;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!(before[i] == source->boxes()[i])) moving.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<double> ms;
  while (ms.size() < kSizingRounds + frames) {
    const Stopwatch clock;
    engine.frame(moving, source->boxes());
    ms.push_back(clock.ms());
    source->advance();
  }
  ms.erase(ms.begin(), ms.begin() + kSizingRounds);
  return ms;
}

std::array<std::vector<double>, 2> measure_worlds(std::string_view partition, std::size_t worlds,
                                                  std::size_t objects_each) {
  Worlds scene(worlds, objects_each);
  FilledPartition together(partition, scene.boxes());
  std::vector<ObjectFilter> filters(together.keys.size());
  for (std::size_t i = 0; i < filters.size(); ++i) {
    filters[i].environment = static_cast<std::uint32_t>(i / objects_each);
  }
  need(together.partition.set_filter(together.keys, filters), "objects");
  const auto of_world = [&](std::size_t w) {
    return std::span(scene.boxes()).subspan(w * objects_each, objects_each);
  };
  std::vector<FilledPartition> apart;
  for (std::size_t w = 0; w < worlds; ++w) apart.emplace_back(partition, of_world(w));

  auto ms = run_interleaved(2, kRounds, kSizingRounds, [&](std::size_t, std::size_t i) {
    if (i == 0) {
      scene.advance();
      return thread_ms([&] { together.frame(scene.boxes()); });
    }
    const double time = thread_ms([&] {
      for (std::size_t w = 0; w < worlds; ++w) apart[w].frame(of_world(w));
    });
    std::size_t pairs = 0;
    for (const FilledPartition& world : apart) pairs += world.pairs.size();
    if (pairs != together.pairs.size()) throw std::runtime_error("other pairs were found");
    return time;
  });
  return {std::move(ms[0]), std::move(ms[1])};
}

}  // namespace winnow::bench
