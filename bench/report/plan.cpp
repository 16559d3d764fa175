// Lists the measurements of a report: for each section, which measurements of bench/rows run on
// which scenes and sizes, and with how many frames. commands/report.cpp runs the steps.

#include "bench/report/report.h"

#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/questions/hard_cases.h"
#include "bench/rows/rows.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace winnow::bench {

extern const char* const kLedger;  // the text of trust/ledger.json

namespace {

constexpr std::size_t kLargestForPeers = 150'000;
/// With more objects, the structures of all instruction sets at once would exceed the memory.
constexpr std::size_t kLargestForOneRace = 300'000;

/// The steps of a report.
struct Plan {
  const ReportOptions& options;
  std::string section{};
  ReportSteps steps{};

  void add(std::string what, std::function<void(Results&)> run) {
    steps.push_back({section, std::move(what), std::move(run)});
  }
  template <typename T>
  [[nodiscard]] T quick_or(T quick, T full) const {
    return options.quick ? quick : full;
  }
  /// Returns the requested scenes. If they are the default ones, only those named in `few`.
  [[nodiscard]] std::vector<NamedScene> few_scenes(const std::vector<std::string>& few) const {
    return are_default() ? named_scenes(few) : options.scenes;
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
  [[nodiscard]] bool are_default() const {
    return std::ranges::equal(options.scenes, main_scenes(), {}, &NamedScene::name);
  }
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

/// Measures partitions without a size limit first, then the slower ones.
void measure_throughput(Results& results, const ReportOptions& options, const NamedScene& scene,
                        std::size_t objects) {
  const Partitions partitions = partitions_for({"all"}, objects);
  note_skipped(results, objects, partitions.skipped, false);
  for (const bool slow : {false, true}) {
    MeasureOptions race{.objects = objects,
                        .seed = options.seed,
                        .partitions = partitions.taken,
                        .threads = options.threads,
                        .isas = options.isas,
                        .yardstick = options.yardstick && !slow,
                        .frames = slow ? frames_of_slow(options.quick, objects)
                                       : throughput_frames(options.quick, objects)};
    std::erase_if(race.partitions, [&](const std::string& name) {
      const bool is_limited = largest_for(name) != std::numeric_limits<std::size_t>::max();
      return is_limited != slow;
    });
    if (race.partitions.empty()) continue;
    if (objects <= kLargestForOneRace) {
      add_frame_race(results, scene, race);
      continue;
    }
    for (const Isa isa : options.isas) {
      race.isas = {isa};
      add_frame_race(results, scene, race);
    }
  }
  derive_frames(results, scene.name, objects);
  const Json where{{"scene", scene.name}, {"objects", objects}};
  if (distinct(results.rows("throughput", where), "fingerprint").size() > 1) {
    throw std::runtime_error("not all found the same pairs");
  }
}

/// Races other libraries, together with a partition that must find the same pairs.
void add_peer_race(Plan& plan, const NamedScene& scene, std::size_t objects,
                   const std::string& name, const std::vector<int>& threads) {
  const MeasureOptions race{.objects = objects,
                            .seed = plan.options.seed,
                            .partitions = {"LinearBvh"},
                            .threads = threads,
                            .isas = {plan.options.isas.back()},
                            .peers = true,
                            .frames = frames_of_slow(plan.options.quick, objects)};
  plan.add(name + ", other libraries", [=](Results& to) {
    add_frame_race(to, scene, race, true);
    derive_frames(to, scene.name, objects);
  });
}

void plan_throughput(Plan& plan) {
  const ReportOptions& options = plan.options;
  plan.each_size(options.scenes, [&](const NamedScene& scene, std::size_t objects, auto name) {
    plan.add(name, [=](Results& to) { measure_throughput(to, options, scene, objects); });
    if (!options.peers || objects > kLargestForPeers) return;
    add_peer_race(plan, scene, objects, name, {options.threads.back()});
  });
  for (const NamedScene& scene : plan.every_scene()) {
    const MeasureOptions race{.objects = scene.objects(plan.objects_up_to(10'000)),
                              .seed = options.seed,
                              .threads = {options.threads.front()},
                              .yardstick = options.yardstick,
                              .frames = plan.quick_or<std::size_t>(kSettlingFrames + 3, 61)};
    plan.add(scene.name + ", worst frames", [=](Results& to) { add_every_scene(to, scene, race); });
  }
  const auto cold = plan.few_scenes(kColdScenes);
  plan.each_size(cold, [&](const NamedScene& scene, std::size_t objects, auto name) {
    if (objects > kLargestForPeers) return;
    const MeasureOptions frames{.objects = objects,
                                .seed = options.seed,
                                .partitions = unlimited_partitions(),
                                .threads = {options.threads.front()},
                                .yardstick = options.yardstick,
                                .frames = options.quick      ? 1U
                                          : objects > 20'000 ? 3U
                                                             : 7U};
    plan.add(name + ", first frames", [=](Results& to) { add_cold(to, scene, frames); });
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
    const MeasureOptions memory{
        .objects = objects, .seed = plan.options.seed, .threads = {plan.options.threads.back()}};
    plan.add(name, [=](Results& to) { add_footprints_apart(to, scene, memory); });
  });
}

void plan_stability(Plan& plan) {
  plan.add("hard cases", [peers = plan.options.peers](Results& to) {
    for (const auto& [family, cases] : hard_cases().items()) {
      add_hard_cases(to, family, cases, peers);
    }
    add_hard_case_totals(to);
  });
}

void plan_motion(Plan& plan) {
  for (const std::string& scene : barrier_names()) {
    const BarrierRowOptions request{.scene = scene,
                                    .steps = plan.quick_or<std::size_t>(5, 200),
                                    .size = plan.quick_or<std::size_t>(8, 0)};
    plan.add("barrier: " + scene, [request](Results& to) { add_barrier(to, request); });
  }
}

/// Runs the races on one scene; `bodies` 0 chooses the scene's default number.
void measure_scene(Results& results, const ReportOptions& options, const std::string& scene,
                   std::size_t bodies) {
  const auto set = make_pipeline_scene(scene, bodies, options.seed);
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
    const PipelineMeasureOptions costs{.scene = scene,
                                       .threads = {1},
                                       .frames = plan.quick_or<std::size_t>(2, 9),
                                       .bodies = plan.quick_or<std::size_t>(60, 0),
                                       .seed = options.seed};
    plan.add(std::string(scene) + ", costs", [=](Results& to) { add_scene_costs(to, costs); });
  }
  for (const std::string& shape : flow_shape_names()) {
    const FlowRowOptions request{.shape = shape,
                                 .objects = plan.quick_or<std::size_t>(60, 500),
                                 .steps = plan.quick_or<std::size_t>(200, 3000),
                                 .seed = options.seed};
    plan.add("granular flow of " + shape, [=](Results& to) { add_flow(to, request); });
  }
  for (const std::string& structure : standing_names()) {
    for (const bool reduced : {false, true}) {
      const StandingRowOptions request{structure, reduced, plan.quick_or(2.0, 60.0)};
      plan.add(structure, [request](Results& to) { add_standing(to, request); });
    }
  }
}

void plan_ranks(Plan& plan) {
  for (const NamedScene& scene : plan.few_scenes({"uniform", "clustered"})) {
    const ClusterRowOptions request{
        .scene = scene,
        .objects = plan.quick_or<std::size_t>(500, 20'000),
        .frames = plan.quick_or<std::size_t>(3, 6),
        .ranks = plan.quick_or<std::vector<std::uint32_t>>({1, 2, 8}, {1, 2, 3, 8, 64, 512}),
        .seed = plan.options.seed};
    plan.add(scene.name, [request](Results& to) { add_cluster_runs(to, request); });
  }
}

void plan_advice(Plan& plan) {
  const ReportOptions& options = plan.options;
  for (const NamedScene& scene : options.scenes) {
    const std::size_t objects = scene.objects(plan.objects_up_to(10'000));
    const auto requested = plan.quick_or<std::size_t>(9, 41);
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

/// Adds the figures of all tests that try to break winnow; bench/trust/record writes them.
void add_ledger(Results& results) {
  for (const Json& row : Json::parse(kLedger)["rows"]) {
    for (const Json& figure : row["figures"]) {
      results.add("trust", {{"row", row["name"]},
                            {"figure", figure["name"]},
                            {"value", figure["value"]},
                            {"date", row["date"]},
                            {"commit", row["commit"]},
                            {"command", row["command"]}});
    }
  }
}

void plan_trust(Plan& plan) {
  plan.add("the ledger of trust", add_ledger);
}

/// Rows that only goals need: frames of every scene and of other libraries on every number of
/// threads, a plain pool of threads, the first frames of AutoPartition, its frames after a change
/// of the scene, worst frames, a flow that is checked by brute force, and frames of a large flow.
void plan_goals(Plan& plan) {
  const ReportOptions& options = plan.options;
  const auto frames = plan.quick_or<std::size_t>(12, 81);
  plan.each_size(plan.every_scene(), [&](const NamedScene& scene, std::size_t objects, auto name) {
    if (objects > kLargestForPeers || scene.name == "growth") return;
    if (std::ranges::find(options.scenes, scene.name, &NamedScene::name) == options.scenes.end()) {
      plan.add(name, [=](Results& to) { measure_throughput(to, options, scene, objects); });
    }
    if (options.peers) add_peer_race(plan, scene, objects, name, options.threads);
  });
  plan.each_size(
      plan.few_scenes({"uniform", "mixed"}), [&](auto scene, std::size_t objects, auto name) {
        const MeasureOptions hosts{.objects = objects,
                                   .seed = options.seed,
                                   .partitions = {"LinearBvh", "SweepAndPrune", "HierarchicalGrid"},
                                   .threads = {options.threads.back()},
                                   .frames = frames};
        plan.add(name + ", a pool of threads", [=](Results& to) { add_hosts(to, scene, hosts); });
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
  const FlowRowOptions flow{.objects = plan.quick_or<std::size_t>(60, 2000),
                            .steps = plan.quick_or<std::size_t>(200, 10'000),
                            .threads = 2,
                            .check = plan.quick_or<std::size_t>(50, 500)};
  plan.add("a long granular flow", [=](Results& to) { add_flow(to, flow); });
  const FlowRowOptions large{.shape = "spheres",
                             .objects = plan.quick_or<std::size_t>(60, 100'000),
                             .steps = plan.quick_or<std::size_t>(50, 400)};
  plan.add("frames of a large flow", [=](Results& to) { add_flow_frames(to, large, 9); });
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
  Plan plan{options};
  for (const auto& [name, add_steps] : kSections) {
    plan.section = name;
    const bool is_default = sections.empty() && add_steps != plan_goals;
    if (is_default || std::ranges::find(sections, name) != sections.end()) add_steps(plan);
  }
  return std::move(plan.steps);
}

}  // namespace winnow::bench
