// Benchmarks of filters in queries of partitions, beside the same queries without filters. The
// results are compared with those of BoundsNSquared, which tests all pairs.

#include "bench/micro/micro.h"

#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/common/sample.h"
#include "bench/contenders/partitions.h"

#include <algorithm>
#include <array>

namespace winnow::bench::micro {
namespace {

constexpr std::size_t kRays = 1000;
constexpr std::size_t kBoxes = 1000;
constexpr std::size_t kFew = 20;  // one object of this many moves
constexpr float kBoxEdges = 4.0F;

/// Two filters, of which each object gets one, and the filter of ray and box queries.
struct Setting {
  std::string_view name;
  /// One of this many objects, at random, gets the second filter. 0: every object in the upper half
  /// of the scene on x.
  std::uint64_t every = 1;
  ObjectFilter first{};
  ObjectFilter second{};
  ObjectFilter query{};

  /// Returns the filter of an object. `middle` divides the boxes on x.
  [[nodiscard]] ObjectFilter filter_of(std::size_t object, const Aabb& box, float middle) const {
    return (every == 0 ? box.min[0] >= middle : mix(object) % every == 0) ? second : first;
  }
};
/// "1 % apart": pairs within a random 1 % of the objects are excluded. "mixed": two random layers,
/// no pairs excluded. "static": pairs within a random nine tenths of the objects are excluded.
/// "never mixed" and "never apart": two layers with pairs only within each, assigned at random or
/// by position. "none": no filters, for comparison.
constexpr std::array<Setting, 6> kSettings{{{"1 % apart", 100, {}, {2, ~2U}, {1, ~2U}},
                                            {"mixed", 2, {1, ~0U}, {2, ~0U}, {1, ~0U}},
                                            {"static", 10, {1, 2}, {2, ~0U}, {2, ~0U}},
                                            {"never mixed", 2, {1, 1}, {2, 2}, {1, 1}},
                                            {"never apart", 0, {1, 1}, {2, 2}, {1, 1}},
                                            {"none"}}};

/// "all move" and "few move" find all pairs after all or few boxes changed; "another" finds pairs
/// with a second partition; "rays" finds closest hits; "boxes" finds objects that overlap boxes.
constexpr std::array<std::string_view, 5> kQuestions{"all move", "few move", "another", "rays",
                                                     "boxes"};
enum QueryCase : std::size_t { all_move, few_move, another, rays, boxes };

/// Sorted results of a query: pairs, or the hit of each ray.
using FoundPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// A partition that follows a scene and runs one query per frame.
class FilteredPartition {
 public:
  FilteredPartition(std::string_view partition, std::size_t question, std::span<const Aabb> first)
      : question_(question),
        boxes_(first.begin(), first.end()),
        other_boxes_(first.rbegin(), first.rend()),
        partition_(make_named(partition, {.execution = Execution::serial()})),
        other_(make_named(partition, {.execution = Execution::serial()})),
        keys_(first.size()),
        other_keys_(first.size()) {
    middle_ = median_by(first, [](const Aabb& box) { return box.min[0]; });
    edge_ = median_by(first, [](const Aabb& box) { return box.max[0] - box.min[0]; });
    need(partition_.insert(boxes_, {}, keys_), "objects");
    if (question_ != another) return;
    // Shifted, so that the two partitions differ.
    for (Aabb& box : other_boxes_) {
      for (Vec3f* const end : {&box.min, &box.max}) (*end)[0] += 0.37F * edge_;
    }
    need(other_.insert(other_boxes_, {}, other_keys_), "objects");
  }

  void set_filters(const Setting& setting) {
    filter_ = {.layers = setting.query.layers, .mask = setting.query.mask, .environment = 0};
    need(partition_.set_filter(keys_, filters_for(setting, boxes_)), "filters");
    if (question_ != another) return;
    need(other_.set_filter(other_keys_, filters_for(setting, other_boxes_)), "filters");
  }

  /// Updates the partition and returns the seconds of the query.
  double run(std::span<const Aabb> frame, std::size_t round) {
    move(frame, round);
    if (question_ != all_move && question_ != few_move) need(partition_.refresh(), "refresh");
    if (question_ == another) need(other_.refresh(), "refresh");
    const ThreadStopwatch clock;
    run_query();
    return 1e-3 * clock.ms();
  }

  /// Returns the results of the last query.
  [[nodiscard]] FoundPairs found() const {
    if (question_ == rays) return hits_;
    FoundPairs all;
    for (const Pair& pair : pairs_) all.emplace_back(pair.first, pair.second);
    std::ranges::sort(all);
    return all;
  }

 private:
  template <typename Value>
  static float median_by(std::span<const Aabb> of, Value&& value) {
    std::vector<float> values;
    for (const Aabb& box : of) values.push_back(value(box));
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }
  [[nodiscard]] std::vector<ObjectFilter> filters_for(const Setting& setting,
                                                      std::span<const Aabb> of) const {
    std::vector<ObjectFilter> filters;
    for (const Aabb& box : of) filters.push_back(setting.filter_of(filters.size(), box, middle_));
    return filters;
  }

  void move(std::span<const Aabb> frame, std::size_t round) {
    if (question_ != few_move) {
      std::ranges::copy(frame.first(boxes_.size()), boxes_.begin());
      return need(partition_.update(keys_, boxes_), "objects");
    }
    std::vector<Key> keys;
    std::vector<Aabb> moved;
    for (std::size_t i = round % kFew; i < boxes_.size(); i += kFew) {
      boxes_[i] = frame[i];
      keys.push_back(keys_[i]);
      moved.push_back(frame[i]);
    }
    need(partition_.update(keys, moved), "objects");
  }

  void run_query() {
    switch (question_) {
      case another:
        return need(partition_.pairs_with(other_, pairs_), "pairs");
      case rays:
        hits_.clear();
        for (std::uint32_t i = 0; i < query_count(kRays); ++i) {
          const Hit hit = need(partition_.closest(Cast(ray(i)), filter_), "rays");
          hits_.emplace_back(i, hit.key.id);
        }
        return;
      case boxes:
        return need(partition_.overlap(regions(), pairs_, filter_), "boxes");
      default:
        return need(partition_.self_pairs(pairs_), "pairs");
    }
  }

  [[nodiscard]] std::uint32_t query_count(std::size_t most) const {
    return static_cast<std::uint32_t>(std::min(most, boxes_.size()));
  }
  /// Returns a ray from a corner of one object towards another.
  [[nodiscard]] Ray ray(std::uint32_t i) const {
    const Vec3f from = other_boxes_[i].min;
    const Vec3f to = other_boxes_[(i + boxes_.size() / 3) % boxes_.size()].max;
    Ray ray;
    ray.origin = from;
    if (!(from == to)) ray.direction = to - from;
    return ray;
  }
  [[nodiscard]] std::vector<Aabb> regions() const {
    std::vector<Aabb> all(other_boxes_.begin(), other_boxes_.begin() + query_count(kBoxes));
    for (Aabb& box : all) box.max = box.min + Vec3f::constant(kBoxEdges * edge_);
    return all;
  }

  std::size_t question_;
  std::vector<Aabb> boxes_;
  std::vector<Aabb> other_boxes_;
  Partition partition_;
  Partition other_;
  std::vector<Key> keys_;
  std::vector<Key> other_keys_;
  float middle_ = 0.0F;
  float edge_ = 0.0F;
  Filter filter_;
  PairBuffer pairs_;
  FoundPairs hits_;
};

/// A partition and the scene that it follows.
struct Following {
  std::unique_ptr<FrameSource> source;
  FilteredPartition partition;
  std::size_t round = 0;

  Following(const NamedScene& scene, std::size_t objects, const std::string& structure,
            std::size_t question, const Setting& setting)
      : source(scene.source(objects, 1)), partition(structure, question, source->boxes()) {
    FilteredPartition reference("BoundsNSquared", question, source->boxes());
    if (setting.name != "none") {
      for (auto* const one : {&partition, &reference}) one->set_filters(setting);
    }
    // The first frames build, and later ones test only what moved.
    for (int warming = 0; warming < 4; ++warming) {
      (void)run();
      (void)reference.run(source->boxes(), round - 1);
    }
    check(partition.found() == reference.found(), "a query returned a wrong result");
  }
  double run() {
    (void)source->advance();
    return partition.run(source->boxes(), round++);
  }
};

}  // namespace

void add_filters(const std::vector<NamedScene>& scenes) {
  for (const NamedScene& scene : scenes) {
    const std::size_t objects = scene.objects(10'000);
    for (std::size_t question = 0; question < kQuestions.size(); ++question) {
      for (const Setting& setting : kSettings) {
        for (const std::string& structure : unlimited_partitions()) {
          const std::string path = "filter/" + word_of(kQuestions[question]) + "/" +
                                   word_of(setting.name) + "/" + word_of(scene.name) +
                                   "/objects:" + std::to_string(objects) + "/" + word_of(structure);
          add(path, [=](benchmark::State& state) {
            auto& following =
                prepared<Following>(path, scene, objects, structure, question, setting);
            run(state, 1, [&] { state.SetIterationTime(following.run()); });
          })->UseManualTime();
        }
      }
    }
  }
}

}  // namespace winnow::bench::micro
