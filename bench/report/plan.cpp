// Lists the measurements of a report: for each section, which races run on which scenes and sizes,
// and with how many frames. report.cpp runs the steps; bench/rows has the measurements.

#include "bench/report/plan.h"

#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/questions/hard_case_files.h"
#include "bench/rows/advice_rows.h"
#include "bench/rows/barrier_rows.h"
#include "bench/rows/choice_rows.h"
#include "bench/rows/cluster_rows.h"
#include "bench/rows/cold_rows.h"
#include "bench/rows/every_scene_rows.h"
#include "bench/rows/flow_rows.h"
#include "bench/rows/frame_rows.h"
#include "bench/rows/hard_case_rows.h"
#include "bench/rows/host_rows.h"
#include "bench/rows/library_comparison_rows.h"
#include "bench/rows/memory_rows.h"
#include "bench/rows/scene_rows.h"
#include "bench/rows/standing_rows.h"
#include "bench/scenes/scene.h"
#include "bench/trust/ledger.h"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

namespace winnow::bench {
namespace {

constexpr std::size_t kLargestForPeers = 150'000;
/// With more objects, the structures of all instruction sets at once would exceed the memory.
constexpr std::size_t kLargestForOneRace = 300'000;

/// The steps of one section.
class Plan {
 public:
  Plan(const ReportOptions& scope, ReportSteps& steps) : options(scope), steps_(steps) {}

  const ReportOptions& options;
  std::string section;

  void add(std::string what, std::function<void(Results&)> run) {
    steps_.push_back({section, std::move(what), std::move(run)});
  }
  /// Returns the requested scenes. If they are the default ones, only those named in `few`.
  [[nodiscard]] std::vector<NamedScene> few_scenes(
      std::initializer_list<std::string_view> few) const {
    if (!are_default()) return options.scenes;
    std::vector<NamedScene> scenes = options.scenes;
    std::erase_if(scenes, [&](const NamedScene& scene) {
      return std::find(few.begin(), few.end(), scene.name) == few.end();
    });
    return scenes;
  }
  [[nodiscard]] std::vector<NamedScene> every_scene() const {
    return are_default() ? named_scenes(scene_names()) : options.scenes;
  }
  /// Returns the largest requested number of objects up to `most`, or the smallest requested.
  [[nodiscard]] std::size_t objects_up_to(std::size_t most) const {
    std::size_t chosen = options.objects.front();
    for (const std::size_t objects : options.objects) {
      if (objects <= most) chosen = objects;
    }
    return chosen;
  }
  /// Calls visit(scene, objects, name) for each scene and size; a recording has only one size.
  template <typename Visit>
  void each_size(const std::vector<NamedScene>& scenes, Visit visit) const {
    for (const NamedScene& scene : scenes) {
      for (const std::size_t requested : options.objects) {
        const std::size_t objects = scene.objects(requested);
        visit(scene, objects, scene.name + ", " + grouped(objects) + " objects");
        if (scene.is_recording()) break;
      }
    }
  }

 private:
  [[nodiscard]] bool are_default() const {
    std::vector<std::string> names;
    for (const NamedScene& scene : options.scenes) names.push_back(scene.name);
    return names == main_scenes();
  }

  ReportSteps& steps_;
};

/// Returns the number of frames whose median is stable at little cost.
std::size_t throughput_frames(bool quick, std::size_t objects) {
  if (quick) return 4;
  if (objects <= 2'000) return 31;
  if (objects <= 20'000) return 21;
  return objects <= kLargestForOneRace ? 11 : 6;
}

std::size_t frames_of_slow(bool quick, std::size_t objects) {
  return quick || objects > 20'000 ? kFingerprintFrames : 6;
}

/// Runs one race of all instruction sets, or one race each if there are too many objects.
void race_partitions(Results& results, const NamedScene& scene, MeasureOptions race) {
  if (race.partitions.empty()) return;
  if (race.objects <= kLargestForOneRace) {
    add_frame_race(results, scene, race);
    return;
  }
  for (const Isa isa : std::exchange(race.isas, {})) {
    race.isas = {isa};
    add_frame_race(results, scene, race);
  }
}

/// Measures partitions without a size limit first, then the slower ones.
void measure_throughput(Results& results, const ReportOptions& options, const NamedScene& scene,
                        std::size_t objects) {
  const Partitions partitions = partitions_for({"all"}, objects);
  note_skipped(results, objects, partitions.skipped, false);
  MeasureOptions fast{.objects = objects,
                      .seed = options.seed,
                      .threads = options.threads,
                      .isas = options.isas,
                      .frames = throughput_frames(options.quick, objects)};
  MeasureOptions slow = fast;
  fast.yardstick = options.yardstick;
  slow.frames = frames_of_slow(options.quick, objects);
  fast.partitions.clear();
  slow.partitions.clear();
  for (const std::string& name : partitions.taken) {
    const bool limited = largest_for(name) != std::numeric_limits<std::size_t>::max();
    (limited ? slow : fast).partitions.push_back(name);
  }
  race_partitions(results, scene, fast);
  race_partitions(results, scene, slow);
  derive_frames(results, scene.name, objects);
  const Json where{{"scene", scene.name}, {"objects", objects}};
  if (distinct(results.rows("throughput", where), "fingerprint").size() > 1) {
    throw std::runtime_error("not all found the same pairs");
  }
}

/// Measures other libraries with the largest number of threads, together with a partition that must
/// find the same pairs.
void measure_peers(Results& results, const ReportOptions& options, const NamedScene& scene,
                   std::size_t objects) {
  add_frame_race(results, scene,
                 {.objects = objects,
                  .seed = options.seed,
                  .partitions = {"LinearBvh"},
                  .threads = {options.threads.back()},
                  .isas = {options.isas.back()},
                  .peers = true,
                  .frames = frames_of_slow(options.quick, objects)},
                 true);
  derive_frames(results, scene.name, objects);
}

void plan_throughput(Plan& plan) {
  const ReportOptions& options = plan.options;
  plan.each_size(options.scenes, [&](const NamedScene& scene, std::size_t objects, auto name) {
    plan.add(name, [=](Results& to) { measure_throughput(to, options, scene, objects); });
    if (!options.peers || objects > kLargestForPeers) return;
    plan.add(name + ", other libraries",
             [=](Results& to) { measure_peers(to, options, scene, objects); });
  });
  for (const NamedScene& scene : plan.every_scene()) {
    EverySceneOptions request{.scene = scene,
                              .objects = scene.objects(plan.objects_up_to(10'000)),
                              .seed = options.seed,
                              .threads = options.threads.front(),
                              .yardstick = options.yardstick};
    if (options.quick) request.frames = kSettlingFrames + 3;
    plan.add(scene.name + ", worst frames", [=](Results& to) { add_every_scene(to, request); });
  }
  const auto cold = plan.few_scenes({"uniform", "mixed", "clustered"});
  plan.each_size(cold, [&](const NamedScene& scene, std::size_t objects, auto name) {
    if (objects > kLargestForPeers) return;
    const std::size_t rounds = options.quick ? 1 : objects > 20'000 ? 3 : 7;
    plan.add(name + ", first frames", [=](Results& to) {
      add_cold(to, scene, objects, options.seed, unlimited_partitions(), options.threads.front(),
               rounds, options.yardstick);
    });
  });
  for (const NamedScene& scene : options.scenes) {
    const std::size_t objects = scene.objects(plan.objects_up_to(100'000));
    plan.add(scene.name + ", limit", [=](Results& to) { add_limit(to, scene.name, objects); });
  }
}

/// Measures two scenes, one with equal sizes and one with mixed sizes: memory depends little on the
/// scene.
void plan_memory(Plan& plan) {
  const auto scenes = plan.few_scenes({"uniform", "mixed"});
  plan.each_size(scenes, [&](const NamedScene& scene, std::size_t objects, auto name) {
    if (objects > kLargestForPeers) return;
    plan.add(name, [=, options = plan.options](Results& to) {
      add_footprints_apart(to, scene, objects, options.seed, options.threads.back());
    });
  });
}

void plan_stability(Plan& plan) {
  plan.add("hard cases", [peers = plan.options.peers](Results& to) {
    for (const HardCaseFile& file : hard_case_files()) {
      add_hard_cases(to, file.family, Json::parse(file.json), peers);
    }
    add_hard_case_totals(to);
  });
}

void plan_motion(Plan& plan) {
  for (const std::string& scene : barrier_names()) {
    BarrierRowOptions request{.scene = scene};
    if (plan.options.quick) {
      request.steps = 5;
      request.size = 8;
    }
    plan.add("barrier: " + scene, [request](Results& to) {
      if (!add_barrier(to, request)) {
        throw std::runtime_error(request.scene + ": something passed through");
      }
    });
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
                              .seed = options.seed};
  for (const bool resting : {false, true}) {
    race.resting = resting;
    add_scene_race(results, race);
  }
  race.resting = false;
  race.threads = {1};
  for (const std::string& level : scene_level_names()) add_scene_level(results, race, level);
}

void plan_pipeline(Plan& plan) {
  const ReportOptions& options = plan.options;
  for (const auto& [scene, quick_bodies] : {std::pair{"pile", 200}, std::pair{"terrain", 40}}) {
    const std::size_t bodies = options.quick ? static_cast<std::size_t>(quick_bodies) : 0;
    plan.add(scene, [=, name = std::string(scene)](Results& to) {
      measure_scene(to, options, name, bodies);
    });
  }
  for (const char* const scene : {"pile", "terrain", "balls"}) {
    SceneCostOptions costs{.scene = scene, .seed = options.seed};
    if (options.quick) {
      costs.bodies = 60;
      costs.frames = 2;
    }
    plan.add(std::string(scene) + ", costs", [=](Results& to) { add_scene_costs(to, costs); });
  }
  for (const std::string& shape : flow_shape_names()) {
    FlowRowOptions request{.shape = shape, .seed = options.seed};
    if (options.quick) {
      request.objects = 60;
      request.steps = 200;
    }
    plan.add("granular flow of " + shape, [=](Results& to) { add_flow(to, request); });
  }
  for (const StandingScene scene : kStandingScenes) {
    for (const bool reduced : {false, true}) {
      const StandingRowOptions request{scene, reduced, options.quick ? 2.0 : 60.0};
      plan.add(name_of(scene), [request](Results& to) {
        if (!add_standing(to, request)) {
          throw std::runtime_error(name_of(request.scene) + " does not stand");
        }
      });
    }
  }
}

void plan_ranks(Plan& plan) {
  for (const NamedScene& scene : plan.few_scenes({"uniform", "clustered"})) {
    ClusterRowOptions request{
        .scene = scene, .ranks = {1, 2, 3, 8, 64, 512}, .seed = plan.options.seed};
    request.is_uniform = scene.name == "uniform" && !scene.is_recording();
    if (plan.options.quick) {
      request.objects = 500;
      request.frames = 3;
      request.ranks = {1, 2, 8};
    }
    plan.add(scene.name, [request](Results& to) { add_cluster_runs(to, request); });
  }
}

void plan_advice(Plan& plan) {
  const ReportOptions& options = plan.options;
  for (const NamedScene& scene : options.scenes) {
    const std::size_t objects = scene.objects(plan.objects_up_to(10'000));
    const std::size_t requested = options.quick ? 9 : 41;
    const std::size_t frames =
        scene.is_recording() ? std::min(requested, scene.recording->frames.size()) : requested;
    for (const int threads : options.threads) {
      plan.add(scene.name + ", " + threads_text(threads), [=, seed = options.seed](Results& to) {
        add_advice(to, scene, objects, seed, partitions_for({"all"}, objects).taken, frames,
                   threads);
      });
    }
  }
}

void plan_trust(Plan& plan) {
  plan.add("the ledger of trust", add_ledger);
}

/// Rows that only goals need: other libraries in every scene, a plain pool of threads, the first
/// frames of AutoPartition, its frames after a change of the scene, worst frames, and a flow that
/// is checked by brute force.
void plan_goals(Plan& plan) {
  const ReportOptions& options = plan.options;
  const std::size_t frames = options.quick ? 12 : 81;
  plan.each_size(plan.every_scene(), [&](const NamedScene& scene, std::size_t objects, auto name) {
    if (!options.peers || objects > kLargestForPeers) return;
    plan.add(name + ", other libraries", [=](Results& to) {
      add_beside_peers(to, scene,
                       {.objects = objects,
                        .partitions = unlimited_partitions(),
                        .threads = options.threads,
                        .frames = objects > 20'000 ? std::min<std::size_t>(26, frames) : frames,
                        .bounds = {.run = 1.0, .frame = 5.0}});
    });
  });
  plan.each_size(plan.few_scenes({"uniform", "mixed"}), [&](auto scene, std::size_t objects,
                                                            auto name) {
    plan.add(name + ", a pool of threads", [=](Results& to) {
      add_hosts(to, scene, objects, options.seed,
                {"LinearBvh", "SweepAndPrune", "HierarchicalGrid"}, options.threads.back(), frames);
    });
  });
  plan.each_size(options.scenes, [&](const NamedScene& scene, std::size_t objects, auto name) {
    for (const int threads : options.threads) {
      plan.add(name + ", first frames of AutoPartition",
               [=](Results& to) { add_first_frames(to, scene, objects, threads); });
    }
  });
  const std::size_t few = plan.objects_up_to(10'000);
  for (const NamedScene& scene : plan.every_scene()) {
    if (scene.name == "growth") continue;  // its frames differ by their number of objects
    plan.add(scene.name + ", worst of many frames", [=](Results& to) {
      add_worst_frames(to, scene, scene.objects(few), options.quick ? 20 : 1000);
    });
  }
  plan.add("changes of the scene",
           [=](Results& to) { add_changes(to, few, options.quick ? 8 : 30); });
  FlowRowOptions flow{.objects = 2000, .steps = 10'000, .threads = 2, .check = 500};
  if (options.quick) flow = {.objects = 60, .steps = 200, .threads = 2, .check = 50};
  plan.add("a long granular flow", [=](Results& to) { add_flow(to, flow); });
}

using PlanSection = std::pair<const char*, void (*)(Plan&)>;
constexpr PlanSection kSections[] = {
    {"throughput", plan_throughput}, {"memory", plan_memory},     {"stability", plan_stability},
    {"motion", plan_motion},         {"pipeline", plan_pipeline}, {"ranks", plan_ranks},
    {"advice", plan_advice},         {"trust", plan_trust},       {"goals", plan_goals}};

}  // namespace

std::vector<std::string> report_sections() {
  std::vector<std::string> names;
  for (const auto& [name, plan] : kSections) names.emplace_back(name);
  return names;
}

ReportSteps report_steps(const ReportOptions& options, const std::vector<std::string>& sections) {
  ReportSteps steps;
  Plan plan(options, steps);
  for (const auto& [name, add_steps] : kSections) {
    const bool is_default = sections.empty() && add_steps != plan_goals;
    if (!is_default && std::find(sections.begin(), sections.end(), name) == sections.end())
      continue;
    plan.section = name;
    add_steps(plan);
  }
  return steps;
}

}  // namespace winnow::bench
