#pragma once

#include <winnow/pipeline/narrow_phase.h>
#include "bench/contenders/engines.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// Errors of one engine on moving pairs.
struct ImpactFaults {
  std::size_t judged = 0;  ///< number of pairs that were checked
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
  [[nodiscard]] ImpactFaults judge(ImpactEngine& engine);

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

}  // namespace winnow::bench
