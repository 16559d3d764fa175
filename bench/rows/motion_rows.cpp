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
  std::string text = "bench/run dev impacts --what pairs --kind " + std::string(options.kind.name) +
                     " --turn \"" + std::string(to_text(options.turn)) + "\" --pairs " +
                     std::to_string(options.pairs) + " --isa " + isa_name();
  if (options.seed != 1) text += " --seed " + std::to_string(options.seed);
  return text;
}

double share_of(std::size_t part, std::size_t of) {
  return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(of, 1));
}

}  // namespace

void declare_motion(Results& results) {
  results.declare({"impacts",
                   "motion",
                   "times of impact of two moving shapes",
                   {"kind", "turning", "engine"},
                   {{"ns", "a pair", "ns", Better::less},
                    {"over_distance", "times winnow's distance query", "", Better::less},
                    {"pairs", "pairs", "", Better::neither, Format::count},
                    {"hits", "of them hit", "", Better::neither, Format::count},
                    {"missed", "missed", "", Better::less, Format::count},
                    {"late", "late", "", Better::less, Format::count},
                    {"loose", "gaps above 1e-6", "", Better::less, Format::count},
                    {"false_share", "missed or late", "", Better::less, Format::percent},
                    {"median_gap", "median gap", "of the radius", Better::less, Format::tiny},
                    {"worst_gap", "worst gap", "of the radius", Better::less, Format::tiny},
                    {"worst_gap_or_floor", "worst gap, at least 1e-12", "of the radius",
                     Better::less, Format::tiny}}});
  results.declare({"feature_impacts",
                   "motion",
                   "times of impact of two features of meshes",
                   {"features", "steps"},
                   {{"ns", "a pair", "ns", Better::less},
                    {"pairs", "pairs", "", Better::neither, Format::count},
                    {"hits", "impacts", "", Better::neither, Format::count},
                    {"missed", "missed or late", "", Better::less, Format::count},
                    {"invented", "invented", "", Better::less, Format::count}}});
  results.declare({"swept_scenes",
                   "motion",
                   "a heap of which some bodies are fast: first impacts beside contacts",
                   {"bodies", "fast", "threads"},
                   {{"collide_ms", "contacts", "ms", Better::less},
                    {"sweep_ms", "impacts of the fast bodies", "ms", Better::less},
                    {"all_ms", "the same while the others jitter", "ms", Better::less},
                    {"over_collide", "impacts over contacts", "", Better::less},
                    {"all_over_collide", "the same while the others jitter", "", Better::less},
                    {"pairs", "pairs tested", "", Better::neither, Format::count},
                    {"impacts", "impacts", "", Better::neither, Format::count}}});
}

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
                   {"command", "bench/run dev impacts --what features --pairs " +
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
       {"command", "bench/run dev impacts --what scene --bodies " + std::to_string(options.bodies) +
                       " --fast " + std::to_string(options.fast) + " --threads " +
                       std::to_string(options.threads) + " --isa " + isa_name()}});
}

}  // namespace winnow::bench
