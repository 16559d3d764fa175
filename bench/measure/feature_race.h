#pragma once

#include <winnow/pipeline/feature_impacts.h>
#include "bench/scenes/feature_steps.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// Times and errors of `feature_impacts` on steps of one kind.
struct FeatureTiming {
  std::size_t pairs = 0;
  std::vector<double> ns{};  ///< ns per pair, one entry per round
  std::size_t hits = 0;
  /// Steps that touch exactly, with no impact reported or a later one.
  std::size_t missed = 0;
  /// Steps that stay apart, with an impact reported.
  std::size_t invented = 0;
};

[[nodiscard]] FeatureTiming measure_features(FeaturePair kind, FeatureSteps steps,
                                             std::size_t pairs, std::size_t rounds,
                                             std::uint64_t seed);

}  // namespace winnow::bench
