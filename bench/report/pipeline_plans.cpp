// Plans the report's sections about the pipeline: narrow phase, hard cases, continuous collision
// detection and scene races. report.cpp runs the steps; bench/rows has the measurements.

#include "bench/questions/hard_case_files.h"
#include "bench/report/section.h"
#include "bench/rows/accuracy_rows.h"
#include "bench/rows/barrier_rows.h"
#include "bench/rows/flow_rows.h"
#include "bench/rows/hard_case_rows.h"
#include "bench/rows/motion_rows.h"
#include "bench/rows/scene_rows.h"
#include "bench/rows/standing_rows.h"

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

/// Keeps only two kinds in a quick report.
std::vector<PairKind> reported(std::span<const PairKind> all, bool quick) {
  std::vector<PairKind> kinds;
  for (const PairKind& kind : all) {
    const bool is_quick = kind.name == "sphere-box" || kind.name == "box-box";
    if (is_quick || !quick) kinds.push_back(kind);
  }
  return kinds;
}

void measure_narrow_times(Results& results, const ReportOptions& options, const PairKind& kind) {
  NarrowMeasureOptions request{
      .kind = kind,
      .pairs = options.quick ? 512U : 8192U,
      .contenders = {.tiers = {NarrowTier::robust, NarrowTier::reference}, .peers = options.peers},
      .seed = options.seed};
  request.race.rounds = options.quick ? 3 : 5;
  if (options.quick) request.race.turn_ms = 0.5;
  if (options.quick) request.race.smallest_part = 128;
  add_pair_times(results, request);
}

/// Returns how many pairs are compared with the oracle, which takes milliseconds for a pair of
/// hulls.
std::size_t judged_pairs(const PairKind& kind, bool quick) {
  if (kind.hull_vertices > 16) return quick ? 4 : 60;
  if (kind.hull_vertices > 0) return quick ? 10 : 500;
  return quick ? 60 : 2000;
}

/// Measures errors of a kind of pairs. For three kinds (one round, one flat, one of hulls) it also
/// measures errors by gap.
void measure_narrow_errors(Results& results, const ReportOptions& options, const PairKind& kind) {
  AccuracyOptions request{.kind = kind, .peers = options.peers, .runs = 5};
  request.set.pairs = judged_pairs(kind, options.quick);
  request.set.seed = options.seed;
  request.levels = {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold};
  const bool by_gap =
      kind.name == "sphere-box" || kind.name == "box-box" || kind.name == "hull16-hull16";
  add_pair_errors(results, request, by_gap);
}

void measure_hard_cases(Results& results, bool peers) {
  for (const HardCaseFile& file : hard_case_files()) {
    add_hard_cases(results, file.family, Json::parse(file.json), peers);
  }
  add_hard_case_totals(results);
}

/// A parameter that makes queries harder, from 1 to 10^last, and the kinds of pairs it applies to.
struct StabilityCurve {
  const char* name;
  std::vector<const char*> kinds;
  int last;
  void (*set)(PairSetOptions&, double);
};

const std::vector<StabilityCurve>& stability_curves() {
  static const std::vector<StabilityCurve> all{
      {"angle",
       {"capsule-capsule", "box-box"},
       -15,
       [](PairSetOptions& set, double value) { set.angle = value; }},
      {"ratio",
       {"sphere-box", "box-box", "hull16-hull16"},
       12,
       [](PairSetOptions& set, double value) { set.ratio = value; }},
      {"offset",
       {"sphere-box", "box-box", "hull16-hull16"},
       12,
       [](PairSetOptions& set, double value) { set.offset = value; }},
      {"thinness",
       {"sphere-triangle", "triangle-triangle"},
       -12,
       [](PairSetOptions& set, double value) { set.thinness = value; }}};
  return all;
}

void measure_stability(Results& results, const ReportOptions& options, const StabilityCurve& curve,
                       const PairKind& kind) {
  const int sign = curve.last < 0 ? -1 : 1;
  for (int power = 0; power <= std::abs(curve.last); power += options.quick ? 6 : 1) {
    const double value = std::stod("1e" + std::to_string(sign * power));
    AccuracyOptions request{.kind = kind, .peers = options.peers, .runs = 1};
    request.set.pairs = options.quick ? 16 : kind.hull_vertices > 0 ? 60 : 200;
    request.set.seed = options.seed;
    curve.set(request.set, value);
    add_error_curve(results, "stability_curves",
                    {{"curve", curve.name}, {"kind", kind.name}, {"parameter", value}}, request);
  }
}

/// Runs the races on one scene; `bodies` 0 chooses the scene's default number.
void measure_scene(Results& results, const ReportOptions& options, const std::string& scene,
                   std::size_t bodies) {
  const std::unique_ptr<BodySet> set = make_pipeline_scene(scene, bodies, options.seed);
  PipelineMeasureOptions race{.scene = scene,
                              .threads = options.threads,
                              .peers = options.peers,
                              .frames = options.quick ? 2U : 5U,
                              .set = set.get(),
                              .bodies = bodies,
                              .seed = options.seed,
                              .machine_clock = false};
  for (const bool resting : {false, true}) {
    race.resting = resting;
    add_scene_race(results, race);
  }
  race.resting = false;
  race.threads = {1};
  for (const std::string& level : scene_level_names()) add_scene_level(results, race, level);
}

}  // namespace

ReportSteps plan_narrow(const ReportOptions& options) {
  ReportSteps steps;
  for (const PairKind& kind : reported(pair_kinds(), options.quick)) {
    steps.push_back({"time of " + std::string(kind.name),
                     options.quick ? 0.1 : kind.hull_vertices * 0.07 + 0.8,
                     [=](Results& results) { measure_narrow_times(results, options, kind); }});
  }
  for (const PairKind& kind : reported(main_pair_kinds(), options.quick)) {
    steps.push_back({"errors of " + std::string(kind.name),
                     options.quick ? 0.05 : kind.hull_vertices * 0.02 + 0.5,
                     [=](Results& results) { measure_narrow_errors(results, options, kind); }});
  }
  return steps;
}

ReportSteps plan_stability(const ReportOptions& options) {
  ReportSteps steps;
  steps.push_back({"hard cases", options.peers ? 1.0 : 0.1,
                   [=](Results& results) { measure_hard_cases(results, options.peers); }});
  for (const StabilityCurve& curve : stability_curves()) {
    for (const char* name : curve.kinds) {
      const PairKind& kind = *find_pair_kind(name);
      if (kind.hull_vertices > 0 && options.quick) continue;
      steps.push_back({std::string(curve.name) + ", " + name,
                       options.quick ? 0.05 : 1.0 + 0.2 * kind.hull_vertices,
                       [&curve, &kind, options](Results& results) {
                         measure_stability(results, options, curve, kind);
                       }});
    }
  }
  return steps;
}

ReportSteps plan_motion(const ReportOptions& options) {
  ReportSteps steps;
  for (const PairKind& kind : reported(main_pair_kinds(), options.quick)) {
    for (const PairTurn turn : kPairTurns) {
      const ImpactRaceOptions request{.kind = kind,
                                      .turn = turn,
                                      .pairs = options.quick ? 64U : 1024U,
                                      .rounds = options.quick ? 2U : 5U,
                                      .peers = options.peers,
                                      .seed = options.seed};
      steps.push_back(
          {"impacts of " + std::string(kind.name) + ", turning: " + std::string(to_text(turn)),
           options.quick ? 0.05 : 0.3 + 0.02 * kind.hull_vertices,
           [request](Results& results) { add_impacts(results, request); }});
    }
  }
  const std::size_t pairs = options.quick ? 200 : 20'000;
  const std::size_t rounds = options.quick ? 2 : 5;
  steps.push_back({"features of meshes", options.quick ? 0.05 : 1.0,
                   [=, seed = options.seed](Results& results) {
                     add_feature_impacts(results, pairs, rounds, seed);
                   }});
  for (const std::string& scene : barrier_names()) {
    BarrierRowOptions request{.scene = scene};
    if (options.quick) {
      request.steps = 5;
      request.size = 8;
    }
    steps.push_back({"barrier: " + scene, options.quick ? 0.1 : 5.0, [request](Results& results) {
                       if (!add_barrier(results, request)) {
                         throw std::runtime_error(request.scene + ": something passed through");
                       }
                     }});
  }
  for (const int threads : options.threads) {
    ContinuousRaceOptions request{.threads = threads, .frames = rounds, .seed = options.seed};
    if (options.quick) {
      request.bodies = 200;
      request.fast = 20;
    }
    steps.push_back({"impacts of a heap", options.quick ? 0.1 : 3.0,
                     [request](Results& results) { add_continuous_collision(results, request); }});
  }
  return steps;
}

ReportSteps plan_pipeline(const ReportOptions& options) {
  ReportSteps steps;
  const auto add_scene = [&](const std::string& scene, std::size_t quick_bodies, double seconds) {
    const std::size_t bodies = options.quick ? quick_bodies : 0;
    const double known = options.peers ? seconds : 0.4 * seconds;
    steps.push_back({scene, options.quick ? 0.2 : known,
                     [=](Results& results) { measure_scene(results, options, scene, bodies); }});
  };
  add_scene("pile", 200, 9.0);
  add_scene("terrain", 40, 3.0);
  for (const char* const scene : {"pile", "terrain", "balls"}) {
    SceneCostOptions costs{.scene = scene, .seed = options.seed};
    if (options.quick) {
      costs.bodies = 60;
      costs.frames = 2;
    }
    steps.push_back({std::string(scene) + ", costs", 4.0,
                     [costs](Results& results) { add_scene_costs(results, costs); }});
  }
  const std::size_t rounds = options.quick ? 2 : 5;
  steps.push_back({"tori", 0.6, [rounds, peers = options.peers](Results& results) {
                     add_tori(results, rounds, peers, false);
                   }});
  for (const std::string& shape : flow_shape_names()) {
    FlowRowOptions request{.shape = shape, .seed = options.seed};
    if (options.quick) {
      request.objects = 60;
      request.steps = 200;
    }
    const double bodies = static_cast<double>(request.objects) * static_cast<double>(request.steps);
    steps.push_back({"granular flow of " + shape, 1.5e-6 * bodies,
                     [request](Results& results) { add_flow(results, request); }});
  }
  for (const StandingScene scene : kStandingScenes) {
    for (const bool reduced : {false, true}) {
      const StandingRowOptions request{scene, reduced, options.quick ? 2.0 : 60.0};
      steps.push_back({name_of(scene), 0.03 * request.seconds, [request](Results& results) {
                         if (!add_standing(results, request)) {
                           throw std::runtime_error(name_of(request.scene) + " does not stand");
                         }
                       }});
    }
  }
  return steps;
}

}  // namespace winnow::bench
