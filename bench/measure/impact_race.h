#pragma once

#include <winnow/pipeline/narrow_phase.h>
#include "bench/contenders/impact_engine.h"
#include "bench/measure/narrow_race.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// Times and errors of one engine on moving pairs.
struct ImpactTiming {
  std::string engine;
  std::vector<double> ns{};  ///< ns per pair, one entry per round
  std::size_t judged = 0;    ///< number of pairs that were checked
  std::size_t hits = 0;
  /// Pairs that overlap at a tested time, with no hit reported.
  std::size_t missed = 0;
  /// Hits reported after the bodies already overlap.
  std::size_t late = 0;
  /// Hits at whose time the bodies are apart by more than a millionth of the smaller one's radius.
  std::size_t loose = 0;
  /// Gap at the time of hits that are not late, over the smaller body's radius.
  double median_gap = 0.0;
  double worst_gap = 0.0;
};

/// Checks times of impact by distances of the pairs at 65 times of each motion and at the reported
/// times.
class ImpactJudge {
 public:
  /// `set` must outlive this.
  explicit ImpactJudge(const MovingPairSet& set);

  /// Runs an engine that was started with the set on all pairs, and checks its results.
  void judge(ImpactEngine& engine, ImpactTiming& timing);

 private:
  [[nodiscard]] double size_of(std::uint32_t body) const;
  /// Returns the distances at one time per pair, by pair.
  const NarrowResult& distances_at(const std::vector<double>& times);

  const MovingPairSet& set_;
  std::vector<Pose> poses_;
  /// By pair, the first tested time at which it overlaps.
  std::vector<double> overlap_;
  NarrowPhase narrow_;
  NarrowResult result_;
};

struct ImpactRaceOptions {
  PairKind kind;
  PairTurn turn = PairTurn::none;
  std::size_t pairs = 2048;
  std::size_t rounds = 7;
  bool peers = false;  ///< also other libraries, if the tool was built with them
  std::uint64_t seed = 1;
};

struct ImpactMeasurement {
  std::vector<ImpactTiming> timings;  ///< winnow first
  /// ns per pair of winnow's distance query on the same pairs in the middle of their motions.
  std::vector<double> distance_ns;
  double machine_ms = 0.0;  ///< of the MachineClock, before and after the race
};

/// Races all engines on the same pairs, with a distance query for comparison, on one thread.
[[nodiscard]] ImpactMeasurement measure_impacts(const ImpactRaceOptions& options);

}  // namespace winnow::bench
