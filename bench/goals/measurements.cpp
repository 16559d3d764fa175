// The measurements that goals refer to by name. Each reads its options, runs a function of
// bench/rows or bench/measure, and stores rows. goals/measurement_cache.cpp calls them through
// `find_measurer`.

#include "bench/goals/measurements.h"

#include "bench/contenders/partitions.h"
#include "bench/goals/scenes_of.h"
#include "bench/measure/partition_costs.h"
#include "bench/questions/hard_cases.h"
#include "bench/rows/advice_rows.h"
#include "bench/rows/barrier_rows.h"
#include "bench/rows/cold_rows.h"
#include "bench/rows/flow_rows.h"
#include "bench/rows/frame_rows.h"
#include "bench/rows/hard_case_rows.h"
#include "bench/rows/host_rows.h"
#include "bench/rows/library_comparison_rows.h"
#include "bench/rows/machine.h"
#include "bench/rows/scene_rows.h"
#include "bench/simulation/flow_phases.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace winnow::bench {
namespace {

/// Number of frames that a goal is measured on.
std::size_t frames_of_goal(std::size_t objects) {
  return objects <= 20'000 ? 81U : objects <= 300'000 ? 26U : 8U;
}

/// Races partitions, by default every partition without a smaller size limit, on 1 and 2 threads,
/// on the active instruction set; "yardstick" adds the yardstick.
void goal_frames(const Json& options, MeasurementCache& /*measurement_cache*/, Measured& measured) {
  declare_frames(measured.results);
  MeasureOptions how{.objects = options.at("objects"), .machine_clock = true};
  how.partitions = options.value("partitions", how.partitions);
  how.threads = options.value("threads", std::vector<int>{1, 2});
  how.frames = options.value("frames", frames_of_goal(how.objects));
  how.yardstick = options.value("yardstick", false);
  if (options.contains("isas")) how.isas.assign(available_isas().begin(), available_isas().end());
  for (const NamedScene& scene : scenes_of(options, measured)) {
    measured.machine_ms = add_frame_race(measured.results, scene, how).machine_ms;
  }
}

/// Races other libraries and partitions, on 1 and 2 threads; each takes at most about "seconds",
/// and a frame at most about "frame_seconds".
void goal_beside_peers(const Json& options, MeasurementCache& /*measurement_cache*/,
                       Measured& measured) {
  measured.absent = !has_peers();
  if (measured.absent) return;
  declare_beside_peers(measured.results);
  for (const NamedScene& scene : scenes_of(options, measured)) {
    measured.machine_ms =
        add_beside_peers(
            measured.results, scene,
            {.objects = options.at("objects"),
             .partitions = options.at("partitions"),
             .threads = {1, 2},
             .machine_clock = true,
             .frames = options.at("frames"),
             .bounds = {.run = options.at("seconds"), .frame = options.at("frame_seconds")}})
            .machine_ms;
  }
}

/// First frames of every partition that suits the size.
void goal_cold(const Json& options, MeasurementCache& /*measurement_cache*/, Measured& measured) {
  declare_cold(measured.results);
  for (const NamedScene& scene : scenes_of(options, measured)) {
    const std::size_t objects = scene.objects(options.value("objects", std::size_t{0}));
    for (const int threads : options.at("threads")) {
      add_cold(measured.results, scene, objects, 1, partitions_for({"all"}, objects).taken,
               threads);
    }
  }
}

/// Frames on a simple thread pool compared with oneTBB.
void goal_hosts(const Json& options, MeasurementCache& /*measurement_cache*/, Measured& measured) {
  declare_hosts(measured.results);
  for (const NamedScene& scene : scenes_of(options, measured)) {
    add_hosts(measured.results, scene, options.at("objects"), 1, options.at("partitions"), 2);
  }
}

/// Compares the pairs of every partition, instruction set and number of threads with the reference.
void goal_same_pairs(const Json& options, MeasurementCache& /*measurement_cache*/,
                     Measured& measured) {
  measured.results.declare({"same_pairs",
                            "engine",
                            "runs against the reference",
                            {"scene", "objects", "partition", "threads", "isa"},
                            {{"differs", "finds other pairs", "", Better::less}}});
  for (const NamedScene& scene : scenes_of(options, measured)) {
    MeasureOptions how{.scene = scene.argument,
                       .recording = scene.recording.get(),
                       .objects = scene.objects(options.value("objects", std::size_t{1})),
                       .threads = options.at("threads"),
                       .reference = true,
                       .frames = scene.is_recording() ? scene.recording->frames.size() : 6};
    how.isas.assign(available_isas().begin(), available_isas().end());
    const Measurement raced = measure(how);
    for (const Run& run : raced.partitions()) {
      measured.results.add("same_pairs", {{"scene", scene.name},
                                          {"objects", raced.objects},
                                          {"partition", run.engine},
                                          {"threads", run.threads},
                                          {"isa", to_string(run.isa)},
                                          {"differs", run.same_pairs(raced.runs.back()) ? 0 : 1}});
    }
  }
}

void goal_limits(const Json& options, MeasurementCache& measurement_cache, Measured& measured) {
  Json frames = Json::object();
  frames["frames"] = options;
  measured.results = measurement_cache.measured(frames).results;
  declare_limits(measured.results);
  add_limit(measured.results, options.at("scene"), options.at("objects"));
}

void goal_advice(const Json& options, MeasurementCache& /*measurement_cache*/, Measured& measured) {
  declare_advice(measured.results);
  for (const NamedScene& scene : scenes_of(options, measured)) {
    const std::size_t objects = scene.objects(options.value("objects", std::size_t{0}));
    const std::size_t frames = scene.is_recording()
                                   ? std::min<std::size_t>(scene.recording->frames.size(), 200)
                                   : frames_of_goal(objects);
    add_advice(measured.results, scene, objects, 1, partitions_for({"all"}, objects).taken, frames,
               options.at("threads"));
  }
}

/// Partitions after many removals and insertions, compared with new ones.
void goal_churn(const Json& options, MeasurementCache& /*measurement_cache*/, Measured& measured) {
  measured.results.declare({"churn",
                            "queries",
                            "a worn partition over a fresh one",
                            {"partition", "of"},
                            {{"ratio", "ratio", "times", Better::less}}});
  for (const std::string partition : options.at("partitions")) {
    for (const auto& [of, ratio] :
         measure_churn(partition, options.at("objects"), options.at("operations"))) {
      measured.results.add("churn", {{"partition", partition}, {"of", of}, {"ratio", ratio}});
    }
  }
}

/// Frames with pair events in which a share of the objects moves.
void goal_pair_events(const Json& options, MeasurementCache& /*measurement_cache*/,
                      Measured& measured) {
  measured.results.declare({"pair_events",
                            "queries",
                            "frames with pair events",
                            {"partition", "share"},
                            {{"ms", "a frame", "ms", Better::less}}});
  const auto shares = options.at("shares").get<std::vector<double>>();
  const std::string partition = options.at("partition");
  const auto ms = measure_event_frames(partition, options.at("objects"), shares);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    measured.results.add("pair_events",
                         {{"partition", partition}, {"share", shares[i]}, {"ms", to_value(ms[i])}});
  }
}

/// Consecutive frames of a scene in which the same objects move.
void goal_quiet_frames(const Json& options, MeasurementCache& /*measurement_cache*/,
                       Measured& measured) {
  measured.results.declare({"quiet_frames",
                            "scenes",
                            "frames in a row in which the same objects move",
                            {"scene", "objects", "partition"},
                            {{"us", "a frame", "us", Better::less}}});
  const std::string scene = options.at("scene");
  const std::size_t objects = options.at("objects");
  for (const std::string partition : options.at("partitions")) {
    std::vector<double> times = measure_quiet_frames(partition, scene, objects, 1000);
    for (double& time : times) time *= 1000.0;
    measured.results.add("quiet_frames", {{"scene", scene},
                                          {"objects", objects},
                                          {"partition", partition},
                                          {"us", to_value(times)}});
  }
}

/// One partition with many environments compared with one partition per environment.
void goal_worlds(const Json& options, MeasurementCache& /*measurement_cache*/, Measured& measured) {
  measured.results.declare({"worlds",
                            "queries",
                            "many small worlds",
                            {"partition", "how"},
                            {{"ms", "a frame", "ms", Better::less}}});
  const std::string partition = options.at("partition");
  const auto ms = measure_worlds(partition, options.at("worlds"), options.at("objects"));
  for (const auto& [how, times] : {std::pair{"together", ms[0]}, std::pair{"apart", ms[1]}}) {
    measured.results.add("worlds",
                         {{"partition", partition}, {"how", how}, {"ms", to_value(times)}});
  }
}

/// Hard cases, from the files of a folder, with both orders of each pair.
void goal_hard_cases(const Json& options, MeasurementCache& /*measurement_cache*/,
                     Measured& measured) {
  declare_hard_cases(measured.results);
  const std::string folder = options.at("folder");
  std::error_code absent;
  for (const auto& file : std::filesystem::directory_iterator(folder, absent)) {
    if (file.path().extension() != ".json") continue;
    const Json questions = read_json(file.path().string());
    const std::string family = file.path().stem().string();
    add_hard_cases(measured.results, family, questions, false);
    add_hard_cases(measured.results, family + ", exchanged", exchanged(questions), false);
  }
  measured.absent = measured.results.rows("hard_cases").empty();
}

void goal_barriers(const Json& options, MeasurementCache& /*measurement_cache*/,
                   Measured& measured) {
  declare_barriers(measured.results);
  for (const std::string& scene : barrier_names()) {
    add_barrier(measured.results, {.scene = scene, .steps = options.at("steps")});
  }
}

void goal_scenes(const Json& options, MeasurementCache& /*measurement_cache*/, Measured& measured) {
  declare_scenes(measured.results);
  measured.machine_ms = add_scene_race(measured.results, {.scene = options.at("scene"),
                                                          .resting = options.at("resting")})
                            .machine_ms;
}

void goal_scene_costs(const Json& options, MeasurementCache& /*measurement_cache*/,
                      Measured& measured) {
  declare_scenes(measured.results);
  add_scene_costs(measured.results, {.scene = options.at("scene")});
}

/// A frame of the granular flow, compared with the sum of its phases measured one by one.
void goal_flow_frames(const Json& options, MeasurementCache& /*measurement_cache*/,
                      Measured& measured) {
  measured.results.declare({"flow_frames",
                            "pipeline",
                            "a frame of a flow, and its phases measured separately",
                            {"how"},
                            {{"ms", "time", "ms", Better::less}}});
  GranularFlow flow(flow_options({.shape = options.at("shape"), .objects = options.at("objects")}));
  flow.keep_contact_poses();
  for (std::size_t i = 0; i < options.at("steps").get<std::size_t>(); ++i) flow.step();
  FlowPhases phases(flow, Execution::serial());
  std::vector<double> frame;
  std::vector<double> separate;
  for (std::size_t i = 0; i < options.at("rounds").get<std::size_t>(); ++i) {
    flow.step();
    frame.push_back(flow.times().move + flow.times().narrow);
    separate.push_back(phases.run().total());
  }
  measured.results.add("flow_frames", {{"how", "frame"}, {"ms", to_value(frame)}});
  measured.results.add("flow_frames", {{"how", "phases"}, {"ms", to_value(separate)}});
}

/// A long granular flow: allocations, energy, and contacts compared with brute force.
void goal_flow_soak(const Json& options, MeasurementCache& /*measurement_cache*/,
                    Measured& measured) {
  declare_flows(measured.results);
  declare_flow_checks(measured.results);
  add_flow(measured.results, {.shape = options.at("shape"),
                              .objects = options.at("objects"),
                              .steps = options.at("steps"),
                              .threads = 2,
                              .check = options.at("check")});
}

}  // namespace

const Measurer* find_measurer(const std::string& name) {
  static const std::map<std::string, Measurer> all{{"frames", goal_frames},
                                                   {"beside_peers", goal_beside_peers},
                                                   {"cold", goal_cold},
                                                   {"hosts", goal_hosts},
                                                   {"same_pairs", goal_same_pairs},
                                                   {"limits", goal_limits},
                                                   {"advice", goal_advice},
                                                   {"first_frames", measure_first_frames},
                                                   {"changes", measure_changes},
                                                   {"worst_frames", measure_worst_frames},
                                                   {"churn", goal_churn},
                                                   {"pair_events", goal_pair_events},
                                                   {"worlds", goal_worlds},
                                                   {"quiet_frames", goal_quiet_frames},
                                                   {"hard_cases", goal_hard_cases},
                                                   {"barriers", goal_barriers},
                                                   {"scenes", goal_scenes},
                                                   {"scene_costs", goal_scene_costs},
                                                   {"flow_frames", goal_flow_frames},
                                                   {"flow_soak", goal_flow_soak},
                                                   {"default_report", measure_default_report},
                                                   {"lone_report", measure_lone_report},
                                                   {"killed_report", measure_killed_report}};
  const auto at = all.find(name);
  return at == all.end() ? nullptr : &at->second;
}

}  // namespace winnow::bench
