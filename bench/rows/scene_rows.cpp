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

void declare_scenes(Results& results, bool levels_by_setting) {
  results.declare({"whole_scenes",
                   "pipeline",
                   "a frame from new poses to contact points",
                   {"scene", "motion", "engine", "threads"},
                   {{"ms", "a frame", "ms", Better::less},
                    {"touching", "touching pairs", "", Better::neither, Format::count},
                    {"points", "contact points", "", Better::neither, Format::count},
                    {"bodies", "bodies", "", Better::neither, Format::count},
                    {"triangles", "triangles", "", Better::neither, Format::count}}});
  results.declare({"scene_ratios",
                   "pipeline",
                   "times of winnow's frame on the first number of threads",
                   {"scene", "motion", "engine", "threads"},
                   {{"ratio", "times winnow's", ""}}});
  const std::vector<std::string> level_keys{"scene", "level"};
  const std::vector<std::string> setting_keys{"scene", "level", "motion", "threads"};
  results.declare({"scene_levels",
                   "pipeline",
                   "a frame by contact level",
                   levels_by_setting ? setting_keys : level_keys,
                   {{"ms", "a frame", "ms", Better::less},
                    {"touching", "pairs reported", "", Better::neither, Format::count},
                    {"points", "contact points", "", Better::neither, Format::count}}});
  results.declare({"scene_costs",
                   "pipeline",
                   "bytes of contacts, and what a margin costs",
                   {"scene", "level", "margin", "threads"},
                   {{"ms", "a frame", "ms", Better::less},
                    {"over_none", "times the frame without a margin", "", Better::less},
                    {"bytes_per_contact", "all bytes a pair that touches", "bytes", Better::less},
                    {"touching", "touching pairs", "", Better::neither, Format::count}}});
}

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
    rows.back()["id"] = results.add("whole_scenes", rows.back());
  }
  const Json& first = rows.front();
  for (const Json& row : rows) {
    if (&row == &first) continue;
    results.add("scene_ratios",
                {{"scene", options.scene},
                 {"motion", motion},
                 {"engine", row["engine"]},
                 {"threads", row["threads"]},
                 {"ratio", value_of(row, "ms") / value_of(first, "ms")},
                 {"from", derived("ratio", "ratio", "ms", {row["id"], first["id"]})}});
  }
  return measured;
}

void add_scene_level(Results& results, PipelineMeasureOptions options, const std::string& level) {
  options.level = ContactLevel::pairs;
  for (const ContactLevel one : kLevels) {
    if (level == to_text(one)) options.level = one;
  }
  options.peers = false;
  const Json& keys = (*results.table("scene_levels"))["keys"];
  const bool by_setting = std::find(keys.begin(), keys.end(), "threads") != keys.end();
  for (const SceneTiming& timing : measure_pipeline(options).timings) {
    Json row{{"scene", options.scene},        {"level", level},
             {"ms", to_value(timing.ms)},     {"touching", timing.finds.touching},
             {"points", timing.finds.points}, {"command", scene_command(options, level)}};
    if (by_setting) {
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
