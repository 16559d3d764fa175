#include "bench/measure/feature_race.h"

#include "bench/common/need.h"
#include "bench/common/sample.h"

#include <cmath>

namespace winnow::bench {

FeatureTiming measure_features(FeaturePair kind, FeatureSteps steps, std::size_t pairs,
                               std::size_t rounds, std::uint64_t seed) {
  const FeatureStepSet set = make_feature_steps(kind, steps, pairs, seed);
  std::vector<double> times(pairs);
  FeatureTiming timing{.pairs = pairs};
  for (std::size_t round = 0; round <= rounds; ++round) {
    const ThreadStopwatch clock;
    need(feature_impacts(kind, set.columns(), times), "features");
    if (round > 0) timing.ns.push_back(clock.ms() * 1e6 / static_cast<double>(pairs));
  }
  for (const double time : times) {
    const bool hit = std::isfinite(time);
    timing.hits += hit ? 1 : 0;
    timing.missed += steps == FeatureSteps::touching && !(time <= kTouchTime) ? 1 : 0;
    timing.invented += steps == FeatureSteps::passing && hit ? 1 : 0;
  }
  return timing;
}

}  // namespace winnow::bench
