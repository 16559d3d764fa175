#include "bench/report/section.h"
#include "bench/rows/volume_rows.h"
#include "bench/scenes/scene.h"

#include <utility>

namespace winnow::bench {
namespace {

/// Ways of objects in a frame, in edges, at which margins are compared.
constexpr double kMarginSteps[] = {0.001, 0.003, 0.01, 0.03, 0.1};

/// Where a built-in scene was not asked for, one of them stands for all: their boxes lie upright.
std::vector<NamedScene> volumes_scenes(const ReportOptions& options) {
  std::vector<std::string> names;
  for (const NamedScene& scene : options.scenes) names.push_back(scene.name);
  if (names == main_scenes()) return {options.scenes.front()};
  return options.scenes;
}

/// What one step measures.
struct VolumesStep {
  VolumeQuestion asked{};
  std::string table = "volumes";
};

std::vector<VolumesStep> volumes_steps(const ReportOptions& options) {
  VolumeQuestion turned{
      .setting = "cubes", .objects = objects_up_to(options, 10'000), .seed = options.seed};
  turned.frames = options.quick ? 2 : volume_frames(turned.objects);
  std::vector<VolumesStep> steps;
  std::vector<VolumeQuestion> bases;
  for (const NamedScene& scene : volumes_scenes(options)) {
    VolumeQuestion asked = turned;
    asked.setting = "scene";
    asked.scene = scene;
    asked.objects = scene.objects(turned.objects);
    asked.frames = options.quick ? 2 : volume_frames(asked.objects);
    if (scene.is_recording()) bases.push_back(asked);
    steps.push_back({asked});
  }
  bases.push_back(turned);
  for (const char* setting : {"cubes", "rods", "slow"}) {
    steps.push_back({turned});
    steps.back().asked.setting = setting;
  }
  for (VolumeQuestion asked : bases) {
    for (const std::string_view partition : volume_partitions()) {
      const bool is_quadratic = partition == "BoundsNSquared" && asked.objects > 2000;
      const bool is_left_out = options.quick && partition != "FlatGrid";
      if (partition == kVolumesPartition || is_quadratic || is_left_out) continue;
      asked.partition = partition;
      steps.push_back({asked});
    }
  }
  for (const double step : kMarginSteps) {
    if (options.quick && step != kMarginSteps[0] && step != 0.1) continue;
    steps.push_back({turned, "margins"});
    steps.back().asked.step = step;
  }
  return steps;
}

std::vector<ReportStep> plan_volumes(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  for (const VolumesStep& step : volumes_steps(options)) {
    const VolumeQuestion& asked = step.asked;
    const std::string what = asked.setting == "scene" ? asked.scene.name : asked.setting;
    constexpr double kEach = 3e-6;  // seconds of an object in a frame
    steps.push_back(
        {what + " in " + asked.partition,
         kEach * static_cast<double>(asked.objects) * static_cast<double>(asked.frames + 1) * 9,
         [step](Results& results) { add_volumes(results, step.asked, step.table); }});
  }
  return steps;
}

/// What a volume gives away beside what it costs, and where the time goes.
void add_volumes_setting(const Results& results, const Json& what, const std::string& id,
                         std::vector<Plot>& plots) {
  const Json where{{"objects_are", what}, {"partition", kVolumesPartition}};
  const Json* first = results.row("volumes", where);
  const std::string title =
      key_text(what) + ", " + shown((*first)["objects"].get<double>(), "count") + " objects";
  Plot front{.id = id + "_front",
             .title = title,
             .x = {"making and broad phase, ms a frame", true},
             .y = {"false positives, share of reported pairs", false}};
  front.series = series_of(
      results, {"volumes", where, "volume", "found_ms", "false_positives", false}, true, false);
  front.series.push_back(pareto_front(front.series));
  plots.push_back(std::move(front));
  Plot bars{.id = id + "_end_to_end",
            .title = title + ", end to end",
            .x = {"volume", false},
            .y = {"ms a frame", false}};
  add_bars(bars, results, {"volumes", where, "volume", {"make_ms", "broad_ms", "narrow_ms"}});
  plots.push_back(std::move(bars));
}

void show_volume_kinds(const Results& results, ReportPage& page) {
  const Json where{{"partition", kVolumesPartition}};
  const auto rows = results.rows("volumes", where);
  if (rows.empty()) return;
  page.heading("Volumes and margins");
  page.paragraph(
      "A broad phase compares simple volumes instead of shapes, and reports pairs that do not "
      "touch: false positives, each of which costs an exact test. Left: the lower, the fewer of "
      "them; the further left, the cheaper; only what lies on the dotted line is worth its price. "
      "Right: the same with the exact test of overlap of every reported pair (boxes, tier robust); "
      "dearer tests move the balance to tighter volumes. Objects of built-in scenes and recordings "
      "are upright boxes: there an AABB is the object itself and reports nothing in vain, but for "
      "rounding. All in " +
      std::string(kVolumesPartition) + ", one thread.");
  std::vector<Plot> plots;
  for (const Json& what : distinct(rows, "objects_are")) {
    add_volumes_setting(results, what, "volumes_" + std::to_string(plots.size() / 2), plots);
  }
  page.add(plots);
  page.command((*rows.front())["command"]);
  for (const char* value : {"false_positives", "found_ms", "sum_ms", "pays_from_ns"}) {
    page.add(pivot(results, {"volumes", where, "volume", "objects_are", value}));
  }
  page.paragraph(
      "The last table: how many nanoseconds the exact test of a pair must cost before the volume "
      "pays off against plain boxes; without a figure, it spares no pair.");
  page.add(pivot(results, {"volumes", where, "volume", "objects_are", "bytes_per_object"}));
}

void show_volume_partitions(const Results& results, ReportPage& page) {
  std::vector<Plot> plots;
  std::vector<PageTable> tables;
  const auto rows = results.rows("volumes");
  for (const Json& what : distinct(rows, "objects_are")) {
    const Json where{{"objects_are", what}};
    if (distinct(results.rows("volumes", where), "partition").size() < 2) continue;
    Plot plot{.id = "volumes_partitions_" + std::to_string(plots.size()),
              .title = key_text(what) + ", every partition",
              .x = {"broad phase, ms a frame", true},
              .y = {"false positives, share of reported pairs", false}};
    plot.series =
        series_of(results, {"volumes", where, "partition", "broad_ms", "false_positives", false},
                  true, false);
    plot.series.push_back(pareto_front(plot.series));
    plots.push_back(std::move(plot));
    const std::string name = key_text(what);
    tables.push_back(pivot(results, {"volumes", where, "partition", "volume", "false_positives",
                                     "false positives, " + name, false}));
    tables.push_back(pivot(results, {"volumes", where, "partition", "volume", "broad_ms",
                                     "broad phase, ms, " + name}));
  }
  if (plots.empty()) return;
  page.heading("The same volumes in other partitions");
  page.paragraph(
      "Every partition hands on exactly the pairs whose volumes overlap, so that it decides the "
      "time and the volume decides the false positives: rows of dots at one height are one volume "
      "in several partitions.");
  page.add(plots);
  for (const PageTable& table : tables) page.add(table);
}

void show_margins(const Results& results, ReportPage& page) {
  if (results.rows("margins").empty()) return;
  page.heading("Margins by speed");
  page.paragraph(
      "A margin lets an object move a little before the partition must be told; the wider, the "
      "more pairs are reported in vain. What it is worth depends on how far objects go in a "
      "frame.");
  std::vector<Plot> plots;
  for (const auto& [value, label] :
       {std::pair{"broad_ms", "broad phase, ms a frame"},
        std::pair{"sum_ms", "volumes, broad phase and exact test, ms a frame"}}) {
    Plot plot{.id = std::string("margins_") + value,
              .title = "rotated cubes",
              .x = {"way in a frame, edges", true},
              .y = {label, true}};
    plot.series =
        series_of(results, {"margins", Json::object(), "volume", "step", value}, true, true);
    plots.push_back(std::move(plot));
  }
  page.add(plots);
  const auto rows = results.rows("margins");
  page.command((*rows.back())["command"]);
  for (const char* value : {"broad_ms", "sum_ms"}) {
    const std::string what = value == std::string("broad_ms") ? "broad phase" : "all three";
    page.add(pivot(results, {"margins", Json::object(), "volume", "step", value,
                             what + ", ms, by edges that objects go in a frame"}));
  }
}

void show_volumes(const Results& results, ReportPage& page) {
  show_volume_kinds(results, page);
  show_volume_partitions(results, page);
  show_margins(results, page);
  for (const char* table : {"volumes", "margins"}) page.all_rows(table);
}

}  // namespace

const ReportSection kVolumesSection{"volumes", "Speed against error: broad phase", declare_volumes,
                                    plan_volumes, show_volumes};

}  // namespace winnow::bench
