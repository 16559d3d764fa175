// Rows about whole scenes: races from poses to contact points against other libraries, levels of
// contact, memory and margins.

#include "bench/rows/rows.h"

#include "bench/rows/machine.h"
#include "bench/scenes/pair_kind.h"

#include <utility>

namespace winnow::bench {
namespace {

const char* motion_of(const PipelineMeasureOptions& options) {
  return options.resting ? "at rest" : "moving a little";
}

/// Works for PipelineMeasureOptions and SceneCostOptions; `what` is an option of the command.
template <typename Options>
std::string pipeline_command(const Options& options, const std::string& what,
                             const std::string& threads) {
  return command_text("dev pipeline --scene ", options.scene, what, " --threads ", threads,
                      " --frames ", options.frames, " --seed ", options.seed, " --isa ", isa_name(),
                      options.bodies != 0 ? " --bodies " + std::to_string(options.bodies) : "");
}

std::string level_command(const PipelineMeasureOptions& options, const std::string& level) {
  std::string threads;
  for (const int count : options.threads) {
    threads += (threads.empty() ? "" : ",") + std::to_string(count);
  }
  return pipeline_command(options, " --level " + level, threads);
}

}  // namespace

void add_scene_race(Results& results, const PipelineMeasureOptions& options) {
  const PipelineMeasurement measured = measure_pipeline(options);
  const double first_ms = median_of(measured.timings.front().ms);
  for (const SceneTiming& timing : measured.timings) {
    const Json keys{{"scene", options.scene},
                    {"motion", motion_of(options)},
                    {"engine", is_peer(timing.engine) ? timing.engine : "winnow"},
                    {"threads", timing.threads}};
    Json row = keys;
    row["ms"] = to_value(timing.ms);
    row["touching"] = timing.finds.touching;
    row["points"] = timing.finds.points;
    row["bodies"] = measured.bodies;
    row["triangles"] = measured.triangles;
    row["command"] = level_command(options, "manifold");
    results.add("whole_scenes", std::move(row));
    if (&timing == &measured.timings.front()) continue;
    Json ratio = keys;
    ratio["ratio"] = median_of(timing.ms) / first_ms;
    results.add("scene_ratios", std::move(ratio));
  }
}

void add_scene_level(Results& results, PipelineMeasureOptions options, const std::string& level) {
  options.level = ContactLevel::pairs;
  for (const ContactLevel one : kLevels) {
    if (level == to_text(one)) options.level = one;
  }
  options.peers = false;
  for (const SceneTiming& timing : measure_pipeline(options).timings) {
    Json row{{"scene", options.scene},        {"level", level},
             {"ms", to_value(timing.ms)},     {"touching", timing.finds.touching},
             {"points", timing.finds.points}, {"command", level_command(options, level)}};
    if (options.resting || timing.threads != 1) {
      row["motion"] = motion_of(options);
      row["threads"] = timing.threads;
    }
    results.add("scene_levels", std::move(row));
  }
}

void add_scene_costs(Results& results, const SceneCostOptions& options) {
  double without = 0.0;
  for (const SceneCost& cost : measure_scene_costs(options)) {
    const double ms = median_of(cost.timing.ms);
    if (cost.contact_margin == 0.0) without = ms;
    const auto touching = static_cast<double>(cost.timing.finds.touching);
    results.add(
        "scene_costs",
        {{"scene", options.scene},
         {"level", to_text(cost.level)},
         {"margin", cost.contact_margin},
         {"threads", options.threads},
         {"ms", to_value(cost.timing.ms)},
         {"over_none", ms / without},
         {"bytes_per_contact", static_cast<double>(cost.timing.bytes) / touching},
         {"touching", cost.timing.finds.touching},
         {"command", pipeline_command(options, " --costs", std::to_string(options.threads))}});
  }
}

std::vector<std::string> scene_level_names() {
  std::vector<std::string> names{"pairs"};
  names.insert(names.end(), kLevelNames.begin(), kLevelNames.end());
  return names;
}

}  // namespace winnow::bench
