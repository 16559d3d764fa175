#pragma once

#include "bench/common/sample.h"
#include "bench/contenders/query_engine.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/measure/judge.h"
#include "bench/recordings/recording.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {

/// Who is asked.
struct QueryContender {
  std::unique_ptr<QueryEngine> engine;
  bool in_float = false;  ///< it computes in float, and is compared accordingly
};

/// One engine that was asked one set of questions in one manner.
struct QueryRun {
  std::string engine;
  std::string set;
  Asking asking = Asking::single;
  int threads = 1;
  std::size_t questions = 0;
  std::uint64_t found = 0;  ///< objects, over all questions
  /// Of question and object of everything found; of any hit, of the questions that had one.
  std::uint64_t fingerprint = 0;
  std::vector<double> ms{};  ///< one entry a round
  Comparison comparison{};   ///< with the first partition that answers the set
  std::string refusal{};     ///< why it did not answer; nothing was measured then

  [[nodiscard]] double found_a_question() const {
    return questions == 0 ? 0.0 : static_cast<double>(found) / static_cast<double>(questions);
  }
  [[nodiscard]] bool answered() const noexcept { return refusal.empty() && !ms.empty(); }
};

struct QueryRaceOptions {
  std::size_t rounds = 5;
  int threads = 1;
  /// Questions of each set that every box is tested for, to check the first engine; 0: none.
  std::size_t judged = 4;
  MachineClock* clock = nullptr;  ///< ticks before each set of questions
};

/// Puts all sets to all contenders, singly and as a batch: once to compare what they find, then in
/// rounds in which they take turns. One thread is timed by what it computes, so that other work on
/// the machine counts for little; several by the clock on the wall. The engines must not have been
/// started.
[[nodiscard]] std::vector<QueryRun> race_queries(std::span<const Aabb> boxes,
                                                 const std::vector<QuestionSet>& sets,
                                                 std::vector<QueryContender>& contenders,
                                                 const QueryRaceOptions& options);

/// One race of questions on the first frame of a scene.
struct QueryMeasureOptions {
  std::string scene{};
  const Recording* recording = nullptr;  ///< instead of the scene
  std::size_t objects = 100'000;
  std::uint64_t seed = 1;
  std::vector<std::string> partitions{"all"};
  int threads = 1;
  std::size_t rays = 100'000;
  std::size_t rounds = 5;
  std::vector<std::string> sets{};  ///< empty: all
  bool machine_clock = true;
  bool peers = false;  ///< other libraries too, where the tool was built with them
};

struct QueryMeasurement {
  std::size_t objects = 0;
  std::vector<QueryRun> runs;
  double machine_ms = 0.0;  ///< of the MachineClock, interleaved with the race, if asked for
};

[[nodiscard]] QueryMeasurement measure_queries(const QueryMeasureOptions& options);

}  // namespace winnow::bench
