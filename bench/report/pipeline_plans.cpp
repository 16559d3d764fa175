// Plans the report's sections about the pipeline: hard cases, fast motion and scene races.
// report.cpp runs the steps; bench/rows has the measurements.

#include "bench/questions/hard_case_files.h"
#include "bench/report/section.h"
#include "bench/rows/barrier_rows.h"
#include "bench/rows/flow_rows.h"
#include "bench/rows/hard_case_rows.h"
#include "bench/rows/scene_rows.h"
#include "bench/rows/standing_rows.h"

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

void measure_hard_cases(Results& results, bool peers) {
  for (const HardCaseFile& file : hard_case_files()) {
    add_hard_cases(results, file.family, Json::parse(file.json), peers);
  }
  add_hard_case_totals(results);
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

ReportSteps plan_stability(const ReportOptions& options) {
  ReportSteps steps;
  steps.push_back({"hard cases", options.peers ? 1.0 : 0.1,
                   [=](Results& results) { measure_hard_cases(results, options.peers); }});
  return steps;
}

ReportSteps plan_motion(const ReportOptions& options) {
  ReportSteps steps;
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
