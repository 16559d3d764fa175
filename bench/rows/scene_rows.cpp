// Rows about whole scenes: races from poses to contact points against other libraries, levels of
// contact, memory and margins. bench/commands, bench/goals and bench/report call these functions.

#include "bench/rows/scene_rows.h"

#include <winnow/simd/isa.h>
#include "bench/rows/machine.h"
#include "bench/scenes/pair_kind.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace winnow::bench {
namespace {

const char* motion_of(const PipelineMeasureOptions& options) {
  return options.resting ? "at rest" : "moving a little";
}

std::string scene_command(const PipelineMeasureOptions& options, const std::string& level) {
  std::string threads;
  for (const int count : options.threads) {
    threads += (threads.empty() ? "" : ",") + std::to_string(count);
  }
  std::string text = "bench/run dev pipeline --scene " + options.scene + " --level " + level +
                     " --threads " + threads + " --frames " + std::to_string(options.frames) +
                     " --seed " + std::to_string(options.seed) + " --isa " + isa_name();
  if (options.bodies != 0) text += " --bodies " + std::to_string(options.bodies);
  return text;
}

}  // namespace

PipelineMeasurement add_scene_race(Results& results, const PipelineMeasureOptions& options) {
  PipelineMeasurement measured = measure_pipeline(options);
  const char* motion = motion_of(options);
  std::vector<Json> rows;
  for (const SceneTiming& timing : measured.timings) {
    rows.push_back({{"scene", options.scene},
                    {"motion", motion},
                    {"engine", is_peer(timing.engine) ? timing.engine : "winnow"},
                    {"threads", timing.threads},
                    {"ms", to_value(timing.ms)},
                    {"touching", timing.finds.touching},
                    {"points", timing.finds.points},
                    {"bodies", measured.bodies},
                    {"triangles", measured.triangles},
                    {"command", scene_command(options, "manifold")}});
    results.add("whole_scenes", rows.back());
  }
  const Json& first = rows.front();
  for (const Json& row : rows) {
    if (&row == &first) continue;
    results.add("scene_ratios", {{"scene", options.scene},
                                 {"motion", motion},
                                 {"engine", row["engine"]},
                                 {"threads", row["threads"]},
                                 {"ratio", value_of(row, "ms") / value_of(first, "ms")}});
  }
  return measured;
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
             {"points", timing.finds.points}, {"command", scene_command(options, level)}};
    if (options.resting || timing.threads != 1) {
      row["motion"] = motion_of(options);
      row["threads"] = timing.threads;
    }
    results.add("scene_levels", std::move(row));
  }
}

void add_scene_costs(Results& results, const SceneCostOptions& options) {
  const std::string again =
      "bench/run dev pipeline --costs --scene " + options.scene + " --threads " +
      std::to_string(options.threads) + " --frames " + std::to_string(options.frames) + " --seed " +
      std::to_string(options.seed) + " --isa " + isa_name() +
      (options.bodies != 0 ? " --bodies " + std::to_string(options.bodies) : "");
  double without = 0.0;
  for (const SceneCost& cost : measure_scene_costs(options)) {
    const double ms = median_of(cost.timing.ms);
    if (cost.contact_margin == 0.0) without = ms;
    const auto touching = static_cast<double>(cost.timing.finds.touching);
    results.add("scene_costs",
                {{"scene", options.scene},
                 {"level", to_text(cost.level)},
                 {"margin", cost.contact_margin},
                 {"threads", options.threads},
                 {"ms", to_value(cost.timing.ms)},
                 {"over_none", ms / without},
                 {"bytes_per_contact", static_cast<double>(cost.timing.bytes) / touching},
                 {"touching", cost.timing.finds.touching},
                 {"command", again}});
  }
}

std::vector<std::string> scene_level_names() {
  std::vector<std::string> names{"pairs"};
  names.insert(names.end(), kLevelNames.begin(), kLevelNames.end());
  return names;
}

}  // namespace winnow::bench
