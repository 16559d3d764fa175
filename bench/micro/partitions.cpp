#include "bench/contenders/partitions.h"
#include "bench/micro/scene.h"
#include "bench/micro/suite.h"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

constexpr std::size_t kObjects = 4096;

/// One partition full of cubes, on one thread. What fails is remembered and ends the benchmark.
class Bench {
 public:
  Bench(const std::string& name, std::size_t objects)
      : partition_(make_named(name, {.execution = Execution::serial()})),
        boxes_{random_cubes(objects), {}},
        keys_(objects) {
    boxes_[1] = moved_cubes(boxes_[0], 0.1F);
    insert();
    pairs(false);
  }

  void insert() {
    note(partition_.insert(boxes_[0], {}, keys_));
    refresh();
  }
  void clear() { partition_.clear(); }
  /// Moves the first `count` objects between their two places.
  void move(std::size_t count) {
    place_ ^= 1U;
    note(partition_.update(std::span(keys_).first(count),
                           std::span<const Aabb>(boxes_[place_]).first(count)));
  }
  void refresh() { note(partition_.refresh()); }
  void pairs(bool incremental) {
    note(partition_.self_pairs(found_, {.incremental = incremental}));
  }
  void finish(benchmark::State& state) const {
    if (failed_) state.SkipWithError("a call was refused");
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(keys_.size()));
  }

 private:
  void note(Status status) { failed_ |= status != Status::ok; }

  Partition partition_;
  std::vector<Aabb> boxes_[2];
  std::vector<Key> keys_;
  PairBuffer found_;
  unsigned place_ = 0;
  bool failed_ = false;
};

/// `frame(bench)` is what is timed; an item is an object.
template <typename Frame>
void add(const std::string& partition, std::size_t objects, const std::string& what, Frame frame) {
  add_per_isa(partition + " " + std::to_string(objects) + ", " + what,
              [=](benchmark::State& state) {
                Bench bench(partition, objects);
                for (auto _ : state) frame(bench);
                bench.finish(state);
              });
}

}  // namespace

void add_partitions() {
  for (const std::size_t objects : {std::size_t{256}, std::size_t{2048}}) {
    add("BoundsNSquared", objects, "all pairs", [](Bench& bench) { bench.pairs(false); });
  }
  for (const std::string name : {"LinearBvh", "FlatGrid", "SweepAndPrune"}) {
    add(name, kObjects, "build", [](Bench& bench) {
      bench.clear();
      bench.insert();
    });
    add(name, kObjects, "all pairs, nothing moved", [](Bench& bench) { bench.pairs(false); });
    add(name, kObjects, "all pairs, all moved", [](Bench& bench) {
      bench.move(kObjects);
      bench.pairs(false);
    });
    add(name, kObjects, "refresh, all moved", [](Bench& bench) {
      bench.move(kObjects);
      bench.refresh();
    });
    add(name, kObjects, "pairs, 5 % moved", [](Bench& bench) {
      bench.move(kObjects / 20);
      bench.pairs(true);
    });
  }
}

}  // namespace winnow::bench
