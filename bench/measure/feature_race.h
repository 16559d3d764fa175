#pragma once

#include <winnow/pipeline/feature_impacts.h>
#include "bench/scenes/feature_steps.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// `feature_impacts` on steps of one kind.
struct FeatureTiming {
  std::size_t pairs = 0;
  std::vector<double> ns{};  ///< a pair, one entry a round
  std::size_t hits = 0;
  /// Steps that touch exactly, and that it says do not, or later.
  std::size_t missed = 0;
  /// Steps that stay apart, and that it says touch.
  std::size_t invented = 0;
};

[[nodiscard]] FeatureTiming measure_features(FeaturePair kind, FeatureSteps steps,
                                             std::size_t pairs, std::size_t rounds,
                                             std::uint64_t seed);

}  // namespace winnow::bench
