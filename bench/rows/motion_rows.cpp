#include "bench/rows/motion_rows.h"

#include <winnow/simd/isa.h>
#include "bench/rows/machine.h"
#include "bench/rows/named_scene.h"

#include <algorithm>
#include <string>

namespace winnow::bench {
namespace {

/// Plots replace smaller gaps by this value, because logarithmic axes have no 0.
constexpr double kMinGapShown = 1e-12;

std::string impacts_command(const ImpactRaceOptions& options) {
  std::string text = "bench/run impacts --what pairs --kind " + std::string(options.kind.name) +
                     " --turn \"" + std::string(to_text(options.turn)) + "\" --pairs " +
                     std::to_string(options.pairs) + " --isa " + isa_name();
  if (options.seed != 1) text += " --seed " + std::to_string(options.seed);
  return text;
}

double share_of(std::size_t part, std::size_t of) {
  return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(of, 1));
}

}  // namespace

ImpactMeasurement add_impacts(Results& results, const ImpactRaceOptions& options) {
  ImpactMeasurement measured = measure_impacts(options);
  const double distance_ns = median_of(measured.distance_ns);
  for (const ImpactTiming& timing : measured.timings) {
    const std::string command = impacts_command(options);
    Json row{{"kind", options.kind.name},
             {"turning", to_text(options.turn)},
             {"engine", timing.engine},
             {"ns", to_value(timing.ns)},
             {"over_distance", median_of(timing.ns) / distance_ns},
             {"pairs", timing.judged},
             {"hits", timing.hits},
             {"missed", timing.missed},
             {"late", timing.late},
             {"loose", timing.loose},
             {"false_share", share_of(timing.missed + timing.late, timing.judged)},
             {"median_gap", timing.median_gap},
             {"worst_gap", timing.worst_gap},
             {"worst_gap_or_floor", std::max(timing.worst_gap, kMinGapShown)},
             {"command", is_peer(timing.engine) ? with_peers(command) : command}};
    results.add("impacts", std::move(row));
  }
  return measured;
}

void add_feature_impacts(Results& results, std::size_t pairs, std::size_t rounds,
                         std::uint64_t seed) {
  for (const FeaturePair kind : kFeaturePairs) {
    for (const FeatureSteps steps : kFeatureSteps) {
      const FeatureTiming timing = measure_features(kind, steps, pairs, rounds, seed);
      results.add("feature_impacts",
                  {{"features", to_text(kind)},
                   {"steps", to_text(steps)},
                   {"ns", to_value(timing.ns)},
                   {"pairs", timing.pairs},
                   {"hits", timing.hits},
                   {"missed", timing.missed},
                   {"invented", timing.invented},
                   {"command", "bench/run impacts --what features --pairs " +
                                   std::to_string(pairs) + " --isa " + isa_name()}});
    }
  }
}

void add_continuous_collision(Results& results, const ContinuousRaceOptions& options) {
  const ContinuousTiming timing = measure_continuous_collision(options);
  const double collide = median_of(timing.collide_ms);
  results.add(
      "swept_scenes",
      {{"bodies", options.bodies},
       {"fast", options.fast},
       {"threads", options.threads},
       {"collide_ms", to_value(timing.collide_ms)},
       {"sweep_ms", to_value(timing.impacts_ms)},
       {"all_ms", to_value(timing.all_ms)},
       {"over_collide", median_of(timing.impacts_ms) / collide},
       {"all_over_collide", median_of(timing.all_ms) / collide},
       {"pairs", timing.pairs},
       {"impacts", timing.impacts},
       {"command", "bench/run impacts --what scene --bodies " + std::to_string(options.bodies) +
                       " --fast " + std::to_string(options.fast) + " --threads " +
                       std::to_string(options.threads) + " --isa " + isa_name()}});
}

}  // namespace winnow::bench
