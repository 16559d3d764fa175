#include "bench/measure/key_costs.h"

#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/common/sample.h"
#include "bench/contenders/partitions.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace winnow::bench {
namespace {

class KeyRounds {
 public:
  KeyRounds(std::string_view partition, std::size_t objects, bool random_order)
      : partition_(make_named(partition, {.execution = Execution::serial()})),
        scene_(make_scene("uniform", objects, 1)),
        keys_(objects),
        batch_(std::clamp<std::size_t>(objects / 10, 1, 100'000)),
        random_order_(random_order) {
    need(partition_.insert(scene_->boxes(), {}, keys_), "keys");
  }

  /// Runs one round and appends its times to `times`.
  void run(KeyMode mode, std::array<std::vector<double>, 3>& times) {
    choose();
    const std::span<Key> keys = std::span(keys_).subspan(first_, batch_);
    const std::span<const Aabb> boxes = scene_->boxes().subspan(first_, batch_);
    const bool bulk = mode == KeyMode::bulk;
    times[2].push_back(timed([&] {
      if (bulk) return partition_.remove(keys);
      return each([&](std::size_t i) { return partition_.remove(keys[i]); });
    }));
    times[0].push_back(timed([&] {
      if (bulk) return partition_.insert(boxes, {}, keys);
      return each([&](std::size_t i) { return partition_.insert(boxes[i], 0, keys[i]); });
    }));
    times[1].push_back(timed([&] {
      if (bulk) return partition_.update(keys, boxes);
      return each([&](std::size_t i) { return partition_.update(keys[i], boxes[i]); });
    }));
  }

 private:
  template <typename Operation>
  Status each(Operation&& operation) const {
    for (std::size_t i = 0; i < batch_; ++i) {
      const Status status = operation(i);
      if (status != Status::ok) return status;
    }
    return Status::ok;
  }

  template <typename Operation>
  double timed(Operation&& operation) {
    need(partition_.refresh(), "keys");
    const Stopwatch clock;
    const Status status = operation();
    const double ns = clock.ms() * 1e6 / static_cast<double>(batch_);
    need(status, "keys");
    return ns;
  }

  /// Selects the next keys in order, or swaps random ones to the front.
  void choose() {
    const std::size_t count = keys_.size();
    if (!random_order_) {
      first_ = first_ + 2 * batch_ <= count ? first_ + batch_ : 0;
      return;
    }
    for (std::size_t i = 0; i < batch_; ++i) {
      const auto rest = static_cast<std::uint32_t>(count - i);
      std::swap(keys_[i], keys_[i + random_.below(rest)]);
    }
  }

  Partition partition_;
  std::unique_ptr<FrameSource> scene_;
  std::vector<Key> keys_;
  std::size_t batch_;
  std::size_t first_ = 0;
  bool random_order_;
  Random random_{1};
};

}  // namespace

KeyCosts measure_key_costs(std::string_view partition, std::size_t objects, bool random_order) {
  KeyRounds rounds(partition, objects, random_order);
  const int count = objects <= 20'000 ? 41 : objects <= 300'000 ? 15 : 5;
  KeyCosts costs{};
  for (std::size_t mode = 0; mode < kKeyModes.size(); ++mode) {
    std::array<std::vector<double>, 3> times;
    for (int i = 0; i < count; ++i) rounds.run(static_cast<KeyMode>(mode), times);
    for (std::size_t op = 0; op < times.size(); ++op) costs[op][mode] = median_of(times[op]);
  }
  return costs;
}

}  // namespace winnow::bench
