#include "bench/measure/upkeep.h"

#include "bench/common/random.h"
#include "bench/common/sample.h"
#include "bench/contenders/partitions.h"
#include "bench/contenders/query_engine.h"
#include "bench/scenes/cameras.h"
#include "bench/scenes/question_set.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>

namespace winnow::bench {
namespace {

constexpr int kRounds = 9;

void require(Status status) {
  if (status != Status::ok) throw Refusal(to_string(status));
}

template <typename Work>
double timed(Work&& work) {
  const ThreadStopwatch clock;
  work();
  return clock.ms();
}

double time_rays(const Partition& partition, const std::vector<Ray>& rays) {
  return timed([&] {
    Hit hit;
    for (const Ray& ray : rays) require(partition.closest(ray, hit));
  });
}

double bytes_of(const Partition& partition) {
  const Footprint footprint = partition.footprint();
  return static_cast<double>(footprint.total().reserved - footprint.results.reserved);
}

/// Removes a random object and inserts another, so many times; pairs are found after a tenth of
/// the objects each.
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
    require(partition.remove(keys[i]));
    require(partition.insert(boxes[i], i, keys[i]));
    if ((done + 1) % frame == 0) require(partition.self_pairs(pairs));
  }
}

/// The frame of a scene, of which some objects take part at a time.
class MovingObjects {
 public:
  explicit MovingObjects(std::size_t objects)
      : scene_(make_scene("uniform", objects, 1)), order_(objects) {
    std::iota(order_.begin(), order_.end(), 0U);
  }

  [[nodiscard]] std::span<const Aabb> boxes() const { return scene_->boxes(); }

  /// The next frame; gives keys and boxes of a random share of the objects.
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

/// Many small scenes, all in the same place, frame by frame in one array.
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
struct Inhabited {
  Partition partition;
  std::vector<Key> keys;
  PairBuffer pairs;

  Inhabited(std::string_view name, std::span<const Aabb> boxes)
      : partition(make_named(name, {.execution = Execution::serial()})), keys(boxes.size()) {
    require(partition.insert(boxes, {}, keys));
  }
  void frame(std::span<const Aabb> boxes) {
    require(partition.update(keys, boxes));
    require(partition.self_pairs(pairs));
  }
};

}  // namespace

ChurnCosts measure_churn(std::string_view partition, std::size_t objects, std::size_t operations) {
  const auto scene = make_scene("uniform", objects, 1);
  std::vector<Aabb> boxes(scene->boxes().begin(), scene->boxes().end());
  Inhabited worn(partition, boxes);
  churn(worn.partition, worn.keys, boxes, operations / 2, worn.pairs);
  Inhabited fresh(partition, boxes);
  const std::vector<std::string> names{"ray closest"};
  const std::vector<Ray> rays = make_question_sets(boxes, 20'000, 1, names).front().rays;

  std::vector<double> pair_ratios;
  std::vector<double> ray_ratios;
  const PairOptions anew{.incremental = false};
  for (int round = 0; round < kRounds; ++round) {
    std::array<double, 2> pair_ms{};
    std::array<double, 2> ray_ms{};
    for (std::size_t which = 0; which < 2; ++which) {
      Inhabited& one = which == 0 ? worn : fresh;
      require(one.partition.self_pairs(one.pairs, anew));  // warms it up
      pair_ms[which] = timed([&] { require(one.partition.self_pairs(one.pairs, anew)); });
      ray_ms[which] = time_rays(one.partition, rays);
    }
    pair_ratios.push_back(pair_ms[0] / pair_ms[1]);
    ray_ratios.push_back(ray_ms[0] / ray_ms[1]);
  }
  return {.self_pairs = median_of(pair_ratios),
          .rays = median_of(ray_ratios),
          .bytes = bytes_of(worn.partition) / bytes_of(fresh.partition),
          .bytes_an_object = bytes_of(worn.partition) / static_cast<double>(objects)};
}

std::vector<double> measure_event_frames(std::string_view partition, std::size_t objects,
                                         const std::vector<double>& shares) {
  MovingObjects moving(objects);
  Inhabited one(partition, moving.boxes());
  PairEvents events;
  std::vector<Key> moved;
  std::vector<Aabb> boxes;
  std::vector<std::vector<double>> ms(shares.size());
  // The first rounds find the sizes of all buffers.
  for (int round = -2; round < kRounds; ++round) {
    for (std::size_t s = 0; s < shares.size(); ++s) {
      moving.advance(shares[s], one.keys, moved, boxes);
      const double time = timed([&] {
        if (!moved.empty()) require(one.partition.update(moved, boxes));
        require(one.partition.self_pairs(one.pairs, events));
      });
      if (round >= 0) ms[s].push_back(time);
    }
  }
  std::vector<double> medians;
  for (const std::vector<double>& times : ms) medians.push_back(median_of(times));
  return medians;
}

WorldCosts measure_worlds(std::string_view partition, std::size_t worlds,
                          std::size_t objects_each) {
  Worlds scene(worlds, objects_each);
  Inhabited together(partition, scene.boxes());
  std::vector<ObjectFilter> filters(together.keys.size());
  for (std::size_t i = 0; i < filters.size(); ++i) {
    filters[i].environment = static_cast<std::uint32_t>(i / objects_each);
  }
  require(together.partition.set_filter(together.keys, filters));
  const auto of_world = [&](std::size_t w) {
    return std::span(scene.boxes()).subspan(w * objects_each, objects_each);
  };
  std::vector<Inhabited> apart;
  for (std::size_t w = 0; w < worlds; ++w) apart.emplace_back(partition, of_world(w));

  std::vector<double> together_ms;
  std::vector<double> apart_ms;
  WorldCosts costs{.same_pairs = true};
  for (int round = -2; round < kRounds; ++round) {
    scene.advance();
    const double one = timed([&] { together.frame(scene.boxes()); });
    const double many = timed([&] {
      for (std::size_t w = 0; w < worlds; ++w) apart[w].frame(of_world(w));
    });
    std::size_t pairs = 0;
    for (const Inhabited& world : apart) pairs += world.pairs.size();
    costs.same_pairs = costs.same_pairs && pairs == together.pairs.size();
    if (round < 0) continue;
    together_ms.push_back(one);
    apart_ms.push_back(many);
  }
  costs.together_ms = median_of(together_ms);
  costs.apart_ms = median_of(apart_ms);
  return costs;
}

}  // namespace winnow::bench
