// Benchmarks of partitions on one frame of a scene: queries, builds, refits, all pairs and
// operations on keys. Embree answers the same queries. All partitions must find what BoundsNSquared
// finds, which tests every box.

#include "bench/micro/micro.h"

#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/common/sample.h"
#include "bench/contenders/partition_queries.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/measure/fingerprint.h"

#include <algorithm>
#include <array>

namespace winnow::bench::micro {
namespace {

constexpr std::size_t kRays = 10'000;
/// Relative difference of t between a partition and a library in float, which rounds three times.
constexpr float kRounding = 3.0F * 0x1p-23F;
constexpr const char* kReference = "BoundsNSquared";
constexpr const char* kParallel = "LinearBvh";  ///< which is also timed on two threads

/// A scene and its number of objects.
struct Where {
  NamedScene scene;
  std::size_t objects = 0;

  [[nodiscard]] std::string path() const {
    return word_of(scene.name) + "/objects:" + std::to_string(objects);
  }
};

/// The boxes of two frames of a scene, its queries, and the pairs of both frames.
struct Input {
  std::array<std::vector<Aabb>, 2> frames;
  std::array<PairSummary, 2> pairs;
  std::vector<QuerySet> sets;

  explicit Input(const Where& where) {
    const auto source = where.scene.source(where.objects, 1);
    for (std::size_t f = 0; f < 2; ++f) {
      frames[f].assign(source->boxes().begin(), source->boxes().end());
      frames[f].resize(frames[0].size());
      ReferenceSweep sweep(-1);
      sweep.start(frames[f]);
      pairs[f] = summarize(sweep.pairs(), frames[f]);
      source->advance();
    }
    sets = make_query_sets(frames[0], kRays, 1);
  }
  [[nodiscard]] std::span<const Aabb> boxes() const { return frames[0]; }
};

Input& input_of(const Where& where) {
  return prepared<Input>(where.path(), where);
}

using MakeQueries = std::function<std::unique_ptr<QueryEngine>(int threads)>;

MakeQueries winnow_queries(const std::string& structure) {
  return [=](int threads) { return std::make_unique<PartitionQueries>(structure, threads); };
}

/// Returns an engine with the boxes of a scene, for all of its queries.
QueryEngine& started_queries(const std::string& name, const MakeQueries& make, const Where& where,
                             int threads) {
  return started<QueryEngine>(
      name + " " + where.path() + " " + std::to_string(threads), [&] { return make(threads); },
      input_of(where).boxes());
}

const QueryResults& expected_results(const Where& where, const QuerySet& set) {
  return prepared_by<QueryResults>(where.path() + " " + set.name, [&] {
    QueryEngine& engine = started_queries(kReference, winnow_queries(kReference), where, 1);
    return std::make_unique<QueryResults>(engine.answers(set, QueryMode::single, set.size()));
  });
}

/// One kind of query by one engine.
struct QueryBenchmark {
  std::string engine;
  MakeQueries make;
  Where where;
  std::size_t set = 0;
  QueryMode mode = QueryMode::single;
  int threads = 1;
  bool is_peer = false;  ///< computes in float; its results are counted but not required

  [[nodiscard]] std::string path() const {
    return "partition/" + word_of(engine) + "/" + std::string(query_set_names()[set]) +
           (mode == QueryMode::batch ? "/batch/" : "/") + where.path() +
           (threads > 1 ? "/threads:" + std::to_string(threads) : "");
  }
};

void time_queries(benchmark::State& state, const QueryBenchmark& what) {
  const QuerySet& set = input_of(what.where).sets[what.set];
  QueryEngine& engine = started_queries(what.engine, what.make, what.where, what.threads);
  const std::size_t count_of_queries = std::min(set.size(), engine.most_questions());
  const QueryResults results = engine.answers(set, what.mode, count_of_queries);
  const std::size_t differing = count_differing(set.query_type, expected_results(what.where, set),
                                                results, what.is_peer ? kRounding : 0.0F);
  check(what.is_peer || differing == 0, "other objects were found");
  const auto* const own = dynamic_cast<const PartitionQueries*>(&engine);
  (void)engine.run(set, what.mode, count_of_queries);
  const std::size_t before = own != nullptr ? own->memory().allocations() : 0;
  std::uint64_t objects = 0;
  run(state, what.threads, [&] { objects = engine.run(set, what.mode, count_of_queries); });
  count_ns(state, "ns_per_query", count_of_queries);
  count(state, "found", objects, count_of_queries);
  count(state, "questions", count_of_queries);
  if (own != nullptr) count(state, "allocations", own->memory().allocations() - before);
  if (what.is_peer) count(state, "differ", differing);
}

/// Registers all queries that the engine supports, one by one and in batches.
void add_queries(QueryBenchmark what) {
  const auto engine = what.make(1);
  for (what.set = 0; what.set < query_set_names().size(); ++what.set) {
    static const Aabb kUnit{{0, 0, 0}, {1, 1, 1}};
    const QuerySet one = make_query_set(query_set_names()[what.set], std::span(&kUnit, 1), 1, 1);
    for (const QueryMode mode : {QueryMode::single, QueryMode::batch}) {
      if (!engine->takes(one, mode)) continue;
      what.mode = mode;
      add(what.path(), what.threads,
          [what](benchmark::State& state) { time_queries(state, what); });
    }
  }
}

void check_pairs(const Partition& partition, const Input& input, std::size_t frame) {
  PairBuffer pairs;
  need(partition.self_pairs(pairs), "pairs");
  check(summarize(pairs.pairs(), input.frames[frame]).same_pairs(input.pairs[frame]),
        "other pairs were found");
}

/// A partition that holds a scene and alternates between its two frames.
struct Alternating {
  const Input& input;
  CountingResource memory{};
  Partition partition;
  std::vector<Key> keys;
  PairBuffer pairs{};
  std::size_t frame = 0;

  Alternating(const std::string& structure, const Where& where)
      : input(input_of(where)),
        partition(make_named(structure, {.memory = &memory, .execution = Execution::serial()})),
        keys(input.boxes().size()) {
    need(partition.insert(input.boxes(), {}, keys), "objects");
    check_pairs(partition, input, 0);
    next();
    check_pairs(partition, input, 1);
  }

  void next() {
    frame = 1 - frame;
    need(partition.update(keys, input.frames[frame]), "objects");
  }
};

void add_build(const std::string& structure, const Where& where) {
  add("partition/" + word_of(structure) + "/build/" + where.path(), [=](benchmark::State& state) {
    const Input& input = input_of(where);
    std::vector<Key> keys(input.boxes().size());
    Partition partition(StructureKind{});
    run(state, 1, [&] {
      state.PauseTiming();
      partition = make_named(structure, {.execution = Execution::serial()});
      state.ResumeTiming();
      need(partition.insert(input.boxes(), {}, keys), "objects");
      need(partition.refresh(), "objects");
    });
    check_pairs(partition, input, 0);
    count_ns(state, "ns_per_object", keys.size());
    count(state, "bytes_per_object", partition.footprint().total().reserved, keys.size());
  });
}

/// Registers a call after all objects moved.
void add_call(const std::string& name, const std::string& structure, const Where& where,
              const std::function<void(Alternating&)>& call) {
  add("partition/" + word_of(structure) + "/" + name + "/" + where.path(),
      [=](benchmark::State& state) {
        auto& moving =
            prepared<Alternating>("moving " + structure + " " + where.path(), structure, where);
        run(state, 1, [&] {
          state.PauseTiming();
          moving.next();
          if (name != "refit") need(moving.partition.refresh(), "objects");
          state.ResumeTiming();
          call(moving);
        });
        count_ns(state, "ns_per_object", moving.keys.size());
        count(state, "bytes_per_object", moving.memory.outstanding(), moving.keys.size());
      });
}

/// Registers what is not a query.
void add_structure(const std::string& structure, const Where& where) {
  add_build(structure, where);
  add_call("refit", structure, where,
           [](Alternating& moving) { need(moving.partition.refresh(), "objects"); });
  add_call("self_pairs", structure, where,
           [](Alternating& moving) { need(moving.partition.self_pairs(moving.pairs), "pairs"); });
}

void add_query_peers(const Where& where, int threads) {
  each_peer<QueryEngine>([&](const QueryEngine& peer, const auto& make) {
    add_queries({.engine = peer.name(),
                 .make = [=](int) { return make(); },
                 .where = where,
                 .threads = threads,
                 .is_peer = true});
  });
}

/// A partition from which a tenth of the objects is removed, inserted again and moved.
class KeyRounds {
 public:
  static constexpr std::array kOperations{"insert", "update", "remove"};

  KeyRounds(const std::string& structure, std::size_t objects, bool random_order)
      : partition_(make_named(structure, {.execution = Execution::serial()})),
        scene_(named_scenes({"uniform"}).front().source(objects, 1)),
        keys_(objects),
        batch_(std::clamp<std::size_t>(objects / 10, 1, 100'000)),
        random_order_(random_order) {
    need(partition_.insert(scene_->boxes(), {}, keys_), "keys");
  }

  [[nodiscard]] std::size_t batch() const { return batch_; }

  /// Runs all operations and returns the seconds of each.
  std::array<double, 3> run(bool bulk) {
    choose();
    const std::span<Key> keys = std::span(keys_).subspan(first_, batch_);
    const std::span<const Aabb> boxes = scene_->boxes().subspan(first_, batch_);
    std::array<double, 3> seconds{};
    seconds[2] = timed([&] {
      return bulk ? partition_.remove(keys)
                  : each([&](std::size_t i) { return partition_.remove(keys[i]); });
    });
    check(partition_.size() == keys_.size() - batch_, "keys were not removed");
    seconds[0] = timed([&] {
      return bulk
                 ? partition_.insert(boxes, {}, keys)
                 : each([&](std::size_t i) { return partition_.insert(boxes[i], 0).get(keys[i]); });
    });
    check(partition_.size() == keys_.size(), "keys were not inserted");
    seconds[1] = timed([&] {
      return bulk ? partition_.update(keys, boxes)
                  : each([&](std::size_t i) { return partition_.update(keys[i], boxes[i]); });
    });
    return seconds;
  }

 private:
  template <typename Operation>
  Status each(Operation&& operation) const {
    Status status = Status::ok;
    for (std::size_t i = 0; i < batch_ && status == Status::ok; ++i) status = operation(i);
    return status;
  }
  template <typename Operation>
  double timed(Operation&& operation) {
    need(partition_.refresh(), "keys");
    const ThreadStopwatch clock;
    const Status status = operation();
    const double seconds = 1e-3 * clock.ms();
    need(status, "keys");
    return seconds;
  }
  /// Selects the next keys in order, or swaps random ones to the front.
  void choose() {
    if (random_order_) {
      random_.draw_front(keys_, batch_);
    } else {
      first_ = first_ + 2 * batch_ <= keys_.size() ? first_ + batch_ : 0;
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

void add_key_operation(std::size_t operation, bool bulk, bool random_order, std::size_t objects,
                       const std::string& structure) {
  const std::string of_keys = std::string(random_order ? "/random" : "/insertion") +
                              "/objects:" + std::to_string(objects) + "/" + word_of(structure);
  add("keys/" + std::string(KeyRounds::kOperations[operation]) + (bulk ? "/bulk" : "/single") +
          of_keys,
      [=](benchmark::State& state) {
        auto& rounds = prepared<KeyRounds>("keys" + of_keys, structure, objects, random_order);
        run(state, 1, [&] { state.SetIterationTime(rounds.run(bulk)[operation]); });
        count_ns(state, "ns_per_object", rounds.batch());
      })
      ->UseManualTime();
}

}  // namespace

void add_partitions(const std::vector<NamedScene>& scenes) {
  for (const NamedScene& scene : scenes) {
    for (const std::size_t requested : {std::size_t{10'000}, std::size_t{100'000}}) {
      const Where where{scene, scene.objects(requested)};
      for (const std::string& structure : testing_partitions()) {
        add_queries({.engine = structure, .make = winnow_queries(structure), .where = where});
        if (where.objects <= largest_for(structure)) add_structure(structure, where);
      }
      add_query_peers(where, 1);
      if (&scene == &scenes.front() && requested == 100'000) {
        add_queries(
            {.engine = kParallel, .make = winnow_queries(kParallel), .where = where, .threads = 2});
        add_query_peers(where, 2);
      }
      if (scene.is_recording()) break;
    }
  }
}

void add_keys() {
  for (const std::string& structure : testing_partitions()) {
    for (const std::size_t objects : {1'000U, 10'000U, 100'000U, 1'000'000U}) {
      for (std::size_t operation = 0; operation < KeyRounds::kOperations.size(); ++operation) {
        for (const bool bulk : {true, false}) {
          for (const bool random_order : {false, true}) {
            add_key_operation(operation, bulk, random_order, objects, structure);
          }
        }
      }
    }
  }
}

}  // namespace winnow::bench::micro
