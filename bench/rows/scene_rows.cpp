// Rows about whole scenes: races from poses to contact points against other libraries, levels of
// contact, memory and margins.

#include "bench/rows/rows.h"

#include "bench/peers/peers.h"
#include "bench/rows/machine.h"
#include "bench/scenes/pair_kind.h"

#include <utility>

namespace winnow::bench {
namespace {

const char* motion_of(const PipelineMeasureOptions& options) {
  return options.resting ? "at rest" : "moving a little";
}

/// `what` is an option of the command.
std::string pipeline_command(const PipelineMeasureOptions& options, const std::string& what) {
  std::string threads;
  for (const int count : options.threads) {
    threads += (threads.empty() ? "" : ",") + std::to_string(count);
  }
  return command_text("dev pipeline --scene ", options.scene, what, " --threads ", threads,
                      " --frames ", options.frames, " --seed ", options.seed, " --isa ", isa_name(),
                      options.bodies != 0 ? " --bodies " + std::to_string(options.bodies) : "");
}

/// Races winnow up to a level and, if wanted, other libraries.
std::vector<SceneTiming> race_of(const PipelineMeasureOptions& options, ContactLevel level,
                                 bool peers) {
  std::vector<SceneContender> contenders;
  const double tolerance = options.resting ? kCacheTolerance : 0.0;
  for (const int threads : options.threads) {
    contenders.push_back(
        {make_winnow_scene(threads, {.cache_tolerance = tolerance, .level = level}), threads});
  }
  for (std::unique_ptr<SceneEngine>& peer : make_peers<SceneEngine>()) {
    if (!peers || (options.resting && !peer->caches_contacts())) continue;
    contenders.push_back({std::move(peer), 1});
  }
  return race_scene(*options.set, options.resting ? kResting : kMoving, contenders, options.frames);
}

}  // namespace

void add_scene_race(Results& results, const PipelineMeasureOptions& options) {
  const auto timings = race_of(options, ContactLevel::manifold, options.peers);
  const double first_ms = median_of(timings.front().ms);
  for (const SceneTiming& timing : timings) {
    const Json keys{{"scene", options.scene},
                    {"motion", motion_of(options)},
                    {"engine", is_peer(timing.engine) ? timing.engine : "winnow"},
                    {"threads", timing.threads}};
    Json row = keys;
    row["ms"] = to_value(timing.ms);
    row["touching"] = timing.finds.touching;
    row["points"] = timing.finds.points;
    row["bodies"] = options.set->poses.size();
    row["triangles"] = options.set->mesh.size();
    row["command"] = pipeline_command(options, " --level manifold");
    results.add("whole_scenes", std::move(row));
    if (&timing == &timings.front()) continue;
    Json ratio = keys;
    ratio["ratio"] = median_of(timing.ms) / first_ms;
    results.add("scene_ratios", std::move(ratio));
  }
}

void add_scene_level(Results& results, const PipelineMeasureOptions& options,
                     const std::string& level) {
  ContactLevel highest = ContactLevel::pairs;
  for (const ContactLevel one : kLevels) {
    if (level == to_text(one)) highest = one;
  }
  for (const SceneTiming& timing : race_of(options, highest, false)) {
    Json row{{"scene", options.scene},
             {"level", level},
             {"ms", to_value(timing.ms)},
             {"touching", timing.finds.touching},
             {"points", timing.finds.points},
             {"command", pipeline_command(options, " --level " + level)}};
    if (options.resting || timing.threads != 1) {
      row["motion"] = motion_of(options);
      row["threads"] = timing.threads;
    }
    results.add("scene_levels", std::move(row));
  }
}

void add_scene_costs(Results& results, const PipelineMeasureOptions& options) {
  constexpr double kMargins[] = {0.0, 0.02};  // the second is a fiftieth of a body's size
  constexpr ContactLevel kCostLevels[] = {ContactLevel::distance, ContactLevel::manifold};
  const int threads = options.threads.front();
  const auto set = make_pipeline_scene(options.scene, options.bodies, options.seed);
  std::vector<SceneContender> contenders;
  for (const ContactLevel level : kCostLevels) {
    for (const double margin : kMargins) {
      contenders.push_back(
          {make_winnow_scene(threads, {.level = level, .contact_margin = margin}), threads});
    }
  }
  const auto timings = race_scene(*set, kMoving, contenders, options.frames);
  for (std::size_t i = 0; i < timings.size(); ++i) {
    const SceneTiming& timing = timings[i];
    const auto touching = static_cast<double>(timing.finds.touching);
    results.add("scene_costs",
                {{"scene", options.scene},
                 {"level", to_text(kCostLevels[i / 2])},
                 {"margin", kMargins[i % 2]},
                 {"threads", threads},
                 {"ms", to_value(timing.ms)},
                 {"over_none", median_of(timing.ms) / median_of(timings[i - i % 2].ms)},
                 {"bytes_per_contact", static_cast<double>(timing.bytes) / touching},
                 {"touching", timing.finds.touching},
                 {"command", pipeline_command(options, " --costs")}});
  }
}

std::vector<std::string> scene_level_names() {
  std::vector<std::string> names{"pairs"};
  names.insert(names.end(), kLevelNames.begin(), kLevelNames.end());
  return names;
}

}  // namespace winnow::bench
