#pragma once

#include <winnow/pipeline/narrow_phase.h>
#include "bench/contenders/impact_engine.h"
#include "bench/measure/narrow_race.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// One engine on moving pairs.
struct ImpactTiming {
  std::string engine;
  std::vector<double> ns{};  ///< a pair, one entry a round
  std::size_t judged = 0;    ///< pairs whose answers were looked at
  std::size_t hits = 0;
  /// Pairs that overlap at some time that was looked at, and that it says do not meet.
  std::size_t missed = 0;
  /// Hits before whose time the bodies overlap.
  std::size_t late = 0;
  /// Hits at whose time the bodies are apart by more than a millionth of the smaller one's radius.
  std::size_t loose = 0;
  /// Of the hits that are not late, the gap at their time over the smaller body's radius.
  double median_gap = 0.0;
  double worst_gap = 0.0;
};

/// Judges answers by distances of the pairs of a set at 64 times of each motion, and at the times
/// that were answered.
class ImpactJudge {
 public:
  /// `set` outlives it.
  explicit ImpactJudge(const MovingPairSet& set);

  /// Asks an engine that was started with the set about all pairs, and judges what it says.
  void judge(ImpactEngine& engine, ImpactTiming& timing);

 private:
  [[nodiscard]] double size_of(std::uint32_t body) const;
  /// By pair.
  const NarrowResult& distances_at(const std::vector<double>& times);

  const MovingPairSet& set_;
  std::vector<Pose> poses_;
  /// By pair, the first time at which it was seen to overlap.
  std::vector<double> overlap_;
  NarrowPhase narrow_;
  NarrowResult result_;
};

struct ImpactRaceOptions {
  PairKind kind;
  PairTurn turn = PairTurn::none;
  std::size_t pairs = 2048;
  std::size_t rounds = 7;
  bool peers = false;  ///< other libraries too, where the tool was built with them
  std::uint64_t seed = 1;
};

struct ImpactMeasurement {
  std::vector<ImpactTiming> timings;  ///< winnow's is the first
  /// winnow's distance query of the same pairs in the middle of their ways, in ns a pair.
  std::vector<double> distance_ns;
  double machine_ms = 0.0;  ///< of the MachineClock, before and after the race
};

/// All engines on the same pairs in turns, and a distance query beside them, one thread.
[[nodiscard]] ImpactMeasurement measure_impacts(const ImpactRaceOptions& options);

}  // namespace winnow::bench
