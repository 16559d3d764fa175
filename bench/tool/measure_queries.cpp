#include "tool/measure_queries.h"

#include "engine/reference_sweep.h"
#include "queries/partition_queries.h"
#include "tool/arguments.h"

#include <algorithm>
#include <optional>

#if WINNOW_HAVE_PEERS
#include "peers/peers.h"
#endif

namespace winnow::bench {
namespace {

std::vector<std::unique_ptr<QueryEngine>> query_peers() {
#if WINNOW_HAVE_PEERS
  return make_query_peers();
#else
  return {};
#endif
}

}  // namespace

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
