#pragma once

#include "bench/common/sample.h"
#include "bench/contenders/query_engine.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/measure/reference_queries.h"
#include "bench/recordings/recording.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {

/// An engine in the race.
struct QueryContender {
  std::unique_ptr<QueryEngine> engine;
  bool in_float = false;  ///< the engine computes in float; its results are compared accordingly
};

/// Results of one engine on one set of queries, single or batched.
struct QueryRun {
  std::string engine;
  std::string set;
  QueryMode mode = QueryMode::single;
  int threads = 1;
  std::size_t questions = 0;
  std::uint64_t found = 0;  ///< number of objects, over all queries
  /// Hash over query and object of all results; for QueryType::any, over the queries with a result.
  std::uint64_t fingerprint = 0;
  std::vector<double> ms{};  ///< one entry per round
  Comparison comparison{};   ///< with the first partition that supports the set
  std::string refusal{};     ///< the error if it failed; nothing is measured then

  [[nodiscard]] double found_a_question() const {
    return questions == 0 ? 0.0 : static_cast<double>(found) / static_cast<double>(questions);
  }
  [[nodiscard]] bool answered() const noexcept { return refusal.empty() && !ms.empty(); }
};

struct QueryRaceOptions {
  std::size_t rounds = 5;
  int threads = 1;
  /// Number of queries per set whose results by the first engine are compared with a test of every
  /// box.
  std::size_t judged = 4;
  MachineClock* clock = nullptr;  ///< ticks before each set of queries
};

/// Runs all sets on all contenders, singly and as a batch: once to compare the results, then in
/// rounds in which they take turns. On one thread the time is the thread's CPU time, which other
/// load on the machine hardly affects; on several it is wall-clock time. The engines must not have
/// been started.
[[nodiscard]] std::vector<QueryRun> race_queries(std::span<const Aabb> boxes,
                                                 const std::vector<QuerySet>& sets,
                                                 std::vector<QueryContender>& contenders,
                                                 const QueryRaceOptions& options);

/// Options of a race of queries on the first frame of a scene.
struct QueryMeasureOptions {
  std::string scene{};
  const Recording* recording = nullptr;  ///< replaces the scene
  std::size_t objects = 100'000;
  std::uint64_t seed = 1;
  std::vector<std::string> partitions{"all"};
  int threads = 1;
  std::size_t rays = 100'000;
  std::size_t rounds = 5;
  std::vector<std::string> sets{};  ///< empty: all
  bool machine_clock = true;
  bool peers = false;  ///< also other libraries, if the tool was built with them
};

struct QueryMeasurement {
  std::size_t objects = 0;
  std::vector<QueryRun> runs;
  double machine_ms = 0.0;  ///< of the MachineClock, interleaved with the race, if enabled
};

[[nodiscard]] QueryMeasurement measure_queries(const QueryMeasureOptions& options);

}  // namespace winnow::bench
