#include "bench/measure/query_race.h"

#include "bench/common/arena.h"
#include "bench/common/random.h"
#include "bench/contenders/partition_queries.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/measure/installed_peers.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <array>
#include <optional>

namespace winnow::bench {

namespace {

/// One question in so many is asked before a turn is timed.
constexpr std::size_t kWarming = 8;

/// One contender in one manner, on the set that is being asked.
struct SetEntry {
  QueryEngine* engine;
  bool in_float;
  QueryRun run;
};

std::uint64_t fingerprint_of_answers(const QuestionSet& set, const Answers& answers) {
  std::uint64_t sum = 0;
  for (std::size_t q = 0; q < answers.questions(); ++q) {
    for (const Found& found : answers.of(q)) {
      const std::uint32_t row = set.want == Want::any ? 0 : found.row;
      sum += mix(std::uint64_t{q} << 32U | row);
    }
  }
  return sum;
}

class SetRace {
 public:
  SetRace(std::span<const Aabb> boxes, const QuestionSet& set,
          std::vector<QueryContender>& contenders, const QueryRaceOptions& options)
      : boxes_(boxes), set_(set), options_(options) {
    for (QueryContender& contender : contenders) {
      for (const Asking asking : {Asking::single, Asking::batch}) {
        if (!contender.engine->takes(set, asking)) continue;
        QueryRun run{.engine = contender.engine->name(),
                     .set = set.name,
                     .asking = asking,
                     .threads = options.threads,
                     .questions = std::min(set.size(), contender.engine->most_questions())};
        entries_.push_back({contender.engine.get(), contender.in_float, std::move(run)});
      }
    }
  }

  /// Compares, and warms everything up.
  void check() {
    const Judge judge(boxes_);
    std::optional<Answers> expected;
    for (SetEntry& entry : entries_) {
      try {
        Answers got = entry.engine->answers(set_, entry.run.asking, entry.run.questions);
        entry.run.fingerprint = fingerprint_of_answers(set_, got);
        if (expected) {
          entry.run.comparison = entry.in_float ? compare_in_float(judge, set_, *expected, got)
                                                : compare_exactly(judge, set_, *expected, got);
        } else if (!entry.in_float) {
          entry.run.comparison = compare_by_force(judge, set_, boxes_.size(), got, options_.judged);
          expected = std::move(got);
        }
      } catch (const Refusal& refusal) {
        entry.run.refusal = refusal.what();
      }
    }
  }

  void time() {
    for (std::size_t round = 0; round < options_.rounds; ++round) {
      for (SetEntry& entry : entries_) {
        if (!entry.run.refusal.empty()) continue;
        // Every turn begins with what the one before left in the caches: a few questions first.
        const std::size_t few = (entry.run.questions + kWarming - 1) / kWarming;
        (void)entry.engine->run(set_, entry.run.asking, few);
        const Stopwatch clock;
        const ThreadStopwatch own_clock;
        entry.run.found = entry.engine->run(set_, entry.run.asking, entry.run.questions);
        entry.run.ms.push_back(options_.threads == 1 ? own_clock.ms() : clock.ms());
      }
    }
  }

  void move_to(std::vector<QueryRun>& runs) {
    for (SetEntry& entry : entries_) runs.push_back(std::move(entry.run));
  }

 private:
  std::span<const Aabb> boxes_;
  const QuestionSet& set_;
  const QueryRaceOptions& options_;
  std::vector<SetEntry> entries_;
};

}  // namespace

std::vector<QueryRun> race_queries(std::span<const Aabb> boxes,
                                   const std::vector<QuestionSet>& sets,
                                   std::vector<QueryContender>& contenders,
                                   const QueryRaceOptions& options) {
  std::vector<QueryRun> runs;
  Arenas arenas(options.threads);
  arenas.run(options.threads, [&] {
    for (QueryContender& contender : contenders) contender.engine->start(boxes);
    for (const QuestionSet& set : sets) {
      if (options.before_set) options.before_set(set);
      SetRace race(boxes, set, contenders, options);
      race.check();
      race.time();
      race.move_to(runs);
    }
  });
  return runs;
}

const QueryRun* find_run(std::span<const QueryRun> runs, const std::string& engine,
                         const std::string& set, Asking asking) noexcept {
  const auto at = std::find_if(runs.begin(), runs.end(), [&](const QueryRun& run) {
    return run.engine == engine && run.set == set && run.asking == asking;
  });
  return at != runs.end() && at->answered() ? &*at : nullptr;
}

bool QueryMeasurement::is_peer(const QueryRun& run) const noexcept {
  return std::find(peers.begin(), peers.end(), run.engine) != peers.end();
}

QueryMeasurement measure_queries(const QueryMeasureOptions& options) {
  const auto source = options.recording != nullptr
                          ? play(*options.recording)
                          : scene_or_error(options.scene, options.objects, options.seed);
  const std::span<const Aabb> boxes = source->boxes();
  QueryMeasurement result;
  result.scene = source->name();
  result.objects = boxes.size();
  const Partitions partitions = partitions_for(options.partitions, result.objects);
  result.skipped = partitions.skipped;

  std::vector<QueryContender> contenders;
  for (const std::string& name : partitions.taken) {
    contenders.push_back({std::make_unique<PartitionQueries>(name, options.threads), false});
  }
  if (options.peers) {
    for (std::unique_ptr<QueryEngine>& peer : query_peers()) {
      result.peers.push_back(peer->name());
      contenders.push_back({std::move(peer), true});
    }
  }
  std::optional<MachineClock> clock;
  if (options.machine_clock) clock.emplace();
  QueryRaceOptions race{.rounds = options.rounds, .threads = options.threads};
  race.before_set = [&](const QuestionSet& set) {
    if (options.before_set) options.before_set(set);
    if (clock) clock->tick();
  };
  const auto sets = make_question_sets(boxes, options.rays, options.seed, options.sets);
  result.runs = race_queries(boxes, sets, contenders, race);
  if (clock) {
    clock->tick();
    result.machine_ms = clock->median_ms();
  }
  return result;
}

}  // namespace winnow::bench
