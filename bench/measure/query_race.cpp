// Races query engines on sets of queries and compares their results. bench/rows/query_rows.cpp
// calls `measure_queries`; comparison.cpp compares the results.

#include "bench/measure/query_race.h"

#include "bench/common/random.h"
#include "bench/common/timed.h"
#include "bench/contenders/partition_queries.h"
#include "bench/peers/peers.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <array>
#include <optional>

namespace winnow::bench {

namespace {

/// One of this many queries is run before a turn is timed.
constexpr std::size_t kWarming = 8;

/// One contender with single or batched queries, on the current set.
struct SetEntry {
  QueryEngine* engine;
  bool in_float;
  QueryRun run;
};

std::uint64_t fingerprint_of_answers(const QuerySet& set, const QueryResults& answers) {
  std::uint64_t sum = 0;
  for (std::size_t q = 0; q < answers.questions(); ++q) {
    for (const Found& found : answers.of(q)) {
      const std::uint32_t row = set.query_type == QueryType::any ? 0 : found.row;
      sum += mix(std::uint64_t{q} << 32U | row);
    }
  }
  return sum;
}

class SetRace {
 public:
  SetRace(std::span<const Aabb> boxes, const QuerySet& set, std::vector<QueryContender>& contenders,
          const QueryRaceOptions& options, Arenas& arenas)
      : boxes_(boxes), set_(set), options_(options), arenas_(arenas) {
    for (QueryContender& contender : contenders) {
      for (const QueryMode mode : {QueryMode::single, QueryMode::batch}) {
        if (!contender.engine->takes(set, mode)) continue;
        QueryRun run{.engine = contender.engine->name(),
                     .set = set.name,
                     .mode = mode,
                     .threads = options.threads,
                     .questions = std::min(set.size(), contender.engine->most_questions())};
        entries_.push_back({contender.engine.get(), contender.in_float, std::move(run)});
      }
    }
  }

  /// Runs each contender once, compares the results, and warms up.
  void check() {
    const ReferenceQueries judge(boxes_);
    std::optional<QueryResults> expected;
    for (SetEntry& entry : entries_) {
      try {
        QueryResults got = entry.engine->answers(set_, entry.run.mode, entry.run.questions);
        entry.run.fingerprint = fingerprint_of_answers(set_, got);
        if (expected) {
          entry.run.comparison = entry.in_float ? compare_in_float(judge, set_, *expected, got)
                                                : compare_exactly(judge, set_, *expected, got);
        } else if (!entry.in_float) {
          entry.run.comparison = compare_by_force(judge, set_, boxes_.size(), got, options_.judged);
          expected = std::move(got);
        }
      } catch (const QueryError& refusal) {
        entry.run.refusal = refusal.what();
      }
    }
  }

  void time() {
    for (std::size_t round = 0; round < options_.rounds; ++round) {
      for (SetEntry& entry : entries_) {
        if (!entry.run.refusal.empty()) continue;
        // Warms the caches, which the previous turn has filled with other data, by a few queries.
        const std::size_t few = (entry.run.questions + kWarming - 1) / kWarming;
        (void)entry.engine->run(set_, entry.run.mode, few);
        entry.run.ms.push_back(timed(options_.threads, arenas_, [&] {
          entry.run.found = entry.engine->run(set_, entry.run.mode, entry.run.questions);
        }));
      }
    }
  }

  void move_to(std::vector<QueryRun>& runs) {
    for (SetEntry& entry : entries_) runs.push_back(std::move(entry.run));
  }

 private:
  std::span<const Aabb> boxes_;
  const QuerySet& set_;
  const QueryRaceOptions& options_;
  Arenas& arenas_;
  std::vector<SetEntry> entries_;
};

}  // namespace

std::vector<QueryRun> race_queries(std::span<const Aabb> boxes, const std::vector<QuerySet>& sets,
                                   std::vector<QueryContender>& contenders,
                                   const QueryRaceOptions& options) {
  std::vector<QueryRun> runs;
  Arenas arenas(options.threads);
  arenas.run(options.threads, [&] {
    for (QueryContender& contender : contenders) contender.engine->start(boxes);
    for (const QuerySet& set : sets) {
      if (options.clock != nullptr) options.clock->tick();
      SetRace race(boxes, set, contenders, options, arenas);
      race.check();
      race.time();
      race.move_to(runs);
    }
  });
  return runs;
}

QueryMeasurement measure_queries(const QueryMeasureOptions& options) {
  const auto source = options.recording != nullptr
                          ? play(*options.recording)
                          : scene_or_error(options.scene, options.objects, options.seed);
  const std::span<const Aabb> boxes = source->boxes();
  QueryMeasurement result;
  result.objects = boxes.size();
  std::vector<QueryContender> contenders;
  for (const std::string& name : partitions_for(options.partitions, result.objects).taken) {
    contenders.push_back({std::make_unique<PartitionQueries>(name, options.threads), false});
  }
  if (options.peers) {
    for (std::unique_ptr<QueryEngine>& peer : make_query_peers()) {
      contenders.push_back({std::move(peer), true});
    }
  }
  MachineClock clock(options.machine_clock);
  const QueryRaceOptions race{
      .rounds = options.rounds, .threads = options.threads, .clock = &clock};
  const auto sets = make_query_sets(boxes, options.rays, options.seed, options.sets);
  result.runs = race_queries(boxes, sets, contenders, race);
  clock.tick();
  result.machine_ms = clock.median_ms();
  return result;
}

}  // namespace winnow::bench
