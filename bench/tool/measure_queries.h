#pragma once

#include "queries/query_race.h"
#include "recordings/recording.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace winnow::bench {

/// One race of questions on the first frame of a scene.
struct QueryMeasureOptions {
  std::string scene;
  const Recording* recording = nullptr;  ///< instead of the scene
  std::size_t objects = 100'000;
  std::uint64_t seed = 1;
  std::vector<std::string> partitions{"all"};
  int threads = 1;
  std::size_t rays = 100'000;
  std::size_t rounds = 5;
  std::vector<std::string> sets;  ///< empty: all
  bool machine_clock = true;
  bool peers = false;  ///< other libraries too, where the tool was built with them
  std::function<void(const QuestionSet&)> before_set;
};

struct QueryMeasurement {
  std::string scene;
  std::size_t objects = 0;
  std::vector<QueryRun> runs;
  std::vector<std::string> peers;    ///< names of the other libraries that took part
  std::vector<std::string> skipped;  ///< too slow for the size
  double machine_ms = 0.0;  ///< of the MachineClock, interleaved with the race, if asked for

  [[nodiscard]] bool is_peer(const QueryRun& run) const noexcept;
};

[[nodiscard]] QueryMeasurement measure_queries(const QueryMeasureOptions& options);

}  // namespace winnow::bench
