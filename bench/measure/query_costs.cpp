#include "bench/measure/query_costs.h"

#include "bench/common/interleaved_runs.h"
#include "bench/common/sample.h"
#include "bench/contenders/partition_queries.h"
#include "bench/measure/column_read.h"
#include "bench/scenes/query_set.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <array>
#include <memory>

namespace winnow::bench {
namespace {

constexpr std::size_t kReadings = 50;

/// The columns of boxes, in the layout of a partition.
class Columns {
 public:
  explicit Columns(std::span<const Aabb> boxes)
      : count_((boxes.size() + 31) / 32 * 32), storage_(6 * count_ + 16) {
    void* start = storage_.data();
    std::size_t space = storage_.size() * sizeof(float);
    auto* aligned = static_cast<float*>(std::align(64, 6 * count_ * sizeof(float), start, space));
    for (std::size_t c = 0; c < 6; ++c) {
      float* column = aligned + c * count_;
      const auto axis = c % 3;
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        column[i] = c < 3 ? boxes[i].min[axis] : boxes[i].max[axis];
      }
      columns_[c] = column;
    }
  }

  /// Returns the milliseconds of reading all columns once.
  [[nodiscard]] double time() const {
    volatile float result = read_columns(columns_.data(), count_);  // warms the caches
    const ThreadStopwatch clock;
    for (std::size_t i = 0; i < kReadings; ++i) result = read_columns(columns_.data(), count_);
    (void)result;
    return clock.ms() / static_cast<double>(kReadings);
  }

 private:
  std::size_t count_;
  std::vector<float> storage_;
  std::array<const float*, 6> columns_{};
};

}  // namespace

FrustumCosts measure_frustum_costs(const std::vector<std::string>& partitions,
                                   const std::string& set, std::size_t objects,
                                   std::size_t rounds) {
  const auto scene = make_scene("uniform", objects, 1);
  const std::span<const Aabb> boxes = scene->boxes();
  const std::vector<std::string> names{set};
  const QuerySet questions = make_query_sets(boxes, 50'000, 1, names).front();
  const Columns columns(boxes);
  std::vector<std::unique_ptr<PartitionQueries>> engines;
  for (const std::string& name : partitions) {
    engines.push_back(std::make_unique<PartitionQueries>(name, 1));
    engines.back()->start(boxes);
  }
  FrustumCosts costs;
  const auto number = static_cast<double>(questions.size());
  costs.ms = run_interleaved(engines.size() + 1, rounds, 0, [&](std::size_t, std::size_t i) {
    if (i == engines.size()) return columns.time();
    (void)engines[i]->run(questions, QueryMode::single, std::min<std::size_t>(4, questions.size()));
    const ThreadStopwatch clock;
    const auto found = engines[i]->run(questions, QueryMode::single, questions.size());
    costs.found_a_question = static_cast<double>(found) / number;
    return clock.ms() / number;
  });
  return costs;
}

std::vector<SecondRound> measure_second_rounds(std::string_view partition, std::size_t objects) {
  const auto scene = make_scene("uniform", objects, 1);
  PartitionQueries engine(partition, 1);
  engine.start(scene->boxes());
  std::vector<SecondRound> rounds;
  for (const QuerySet& set : make_query_sets(scene->boxes(), 2000, 1)) {
    for (const QueryMode mode : {QueryMode::single, QueryMode::batch}) {
      if (!engine.takes(set, mode)) continue;
      const std::size_t count = std::min(set.size(), engine.most_questions());
      (void)engine.run(set, mode, count);
      const std::size_t before = engine.memory().allocations();
      (void)engine.run(set, mode, count);
      rounds.push_back({set.name + (mode == QueryMode::single ? "" : ", as a batch"),
                        engine.memory().allocations() - before});
    }
  }
  return rounds;
}

}  // namespace winnow::bench
