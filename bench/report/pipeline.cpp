#include "bench/common/table.h"
#include "bench/report/section.h"
#include "bench/rows/flow_rows.h"
#include "bench/rows/scene_rows.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace winnow::bench {
namespace {

void declare_pipeline(Results& results) {
  declare_scenes(results);
  declare_flows(results);
}

/// The races on one scene; `bodies` 0: as many as suit it.
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

std::vector<ReportStep> plan_pipeline(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  const auto add_scene = [&](const std::string& scene, std::size_t quick_bodies, double seconds) {
    const std::size_t bodies = options.quick ? quick_bodies : 0;
    const double known = options.peers ? seconds : 0.4 * seconds;
    steps.push_back({scene, options.quick ? 0.2 : known,
                     [=](Results& results) { measure_scene(results, options, scene, bodies); }});
  };
  add_scene("pile", 200, 9.0);
  add_scene("terrain", 40, 3.0);
  const std::size_t rounds = options.quick ? 2 : 5;
  steps.push_back({"tori", 0.6, [rounds, peers = options.peers](Results& results) {
                     add_tori(results, rounds, peers, false);
                   }});
  for (const std::string& shape : flow_shape_names()) {
    FlowQuestion asked{.shape = shape, .seed = options.seed};
    if (options.quick) {
      asked.objects = 60;
      asked.steps = 200;
    }
    const double bodies = static_cast<double>(asked.objects) * static_cast<double>(asked.steps);
    steps.push_back({"granular flow of " + shape, 1.5e-6 * bodies,
                     [asked](Results& results) { add_flow(results, asked); }});
  }
  return steps;
}

std::vector<Plot> scene_plots(const Results& results) {
  const auto rows = results.rows("whole_scenes");
  std::vector<Plot> plots;
  for (const Json& scene : distinct(rows, "scene")) {
    for (const Json& motion : distinct(rows, "motion")) {
      const Json where{{"scene", scene}, {"motion", motion}, {"threads", 1}};
      Plot plot{.id = "scene_" + key_text(scene) + "_" + std::to_string(plots.size()),
                .title = key_text(scene) + ", " + key_text(motion),
                .x = {"engine, 1 thread", false},
                .y = {"ms a frame", false}};
      add_bars(plot, results, {"whole_scenes", where, "engine", {"ms"}});
      plots.push_back(std::move(plot));
    }
  }
  return plots;
}

PageTable scene_table(const Results& results) {
  PageTable table{"",
                  {"scene", "bodies", "triangles", "motion", "engine", "threads", "ms a frame",
                   "touching pairs", "contact points", "times winnow's"},
                  {}};
  for (const Json* row : results.rows("whole_scenes")) {
    Json where;
    for (const char* key : {"scene", "motion", "engine", "threads"}) where[key] = (*row)[key];
    const auto key_cell = [&](const char* key) { return text_cell(key_text((*row)[key])); };
    const auto value_cell = [&](const char* value) {
      return cell(results, "whole_scenes", row, value);
    };
    table.rows.push_back(
        {key_cell("scene"), value_cell("bodies"), value_cell("triangles"), key_cell("motion"),
         key_cell("engine"), key_cell("threads"), value_cell("ms"), value_cell("touching"),
         value_cell("points"),
         cell(results, "scene_ratios", results.row("scene_ratios", where), "ratio")});
  }
  return table;
}

void show_tori(const Results& results, ReportPage& page) {
  if (results.rows("tori").empty()) return;
  page.heading("Two meshes");
  page.paragraph(
      "Two tori of 20,000 triangles each, in four poses: all contacts between their triangles, and "
      "the tree that finds them.");
  Plot plot{.id = "pipeline_tori",
            .title = "two tori",
            .x = {"pairs of triangles that touch", true},
            .y = {"ms", true}};
  plot.series = series_of(results, {"tori", Json::object(), "engine", "pairs", "ms"}, true, true);
  page.add({plot});
  page.command((*results.rows("tori").front())["command"]);
  for (const char* value : {"ms", "pairs", "differ"}) {
    page.add(pivot(results, {"tori", Json::object(), "engine", "pose", value}));
  }
  PageTable builds{"the tree of one torus", {"engine", "build, ms", "bytes/triangle"}, {}};
  for (const Json* row : results.rows("mesh_builds")) {
    builds.rows.push_back({text_cell((*row)["engine"]), cell(results, "mesh_builds", row, "ms"),
                           cell(results, "mesh_builds", row, "bytes_per_triangle")});
  }
  page.add(builds);
}

void show_levels(const Results& results, ReportPage& page) {
  if (results.rows("scene_levels").empty()) return;
  page.heading("How much is asked for");
  page.paragraph(
      "The same frames on one thread, bodies moving a little, but only pairs of bounds (the broad "
      "phase alone), or whether bodies overlap, or how far and how deep, or all contact points.");
  page.add(pivot(results, {"scene_levels", Json::object(), "level", "scene", "ms", "", false}));
}

void show_whole_scenes(const Results& results, ReportPage& page) {
  const auto rows = results.rows("whole_scenes");
  if (!rows.empty()) {
    page.heading("Whole scenes");
    page.paragraph(
        "A pile of spheres, capsules, boxes and hulls, and hulls on a terrain of triangles: "
        "milliseconds from new poses to contact points. Bodies at rest jitter by less than what a "
        "solver leaves, and contacts are carried over; who cannot do that is left out. The table "
        "says what each found beside the time, so that less work does not pass for speed.");
    page.add(scene_plots(results));
    page.command((*rows.front())["command"]);
    page.add(scene_table(results));
  }
  show_levels(results, page);
  show_tori(results, page);
}

/// A line for each of these values of the rows of `flow`.
std::vector<PlotSeries> flow_lines(const Results& results, const Json& shape,
                                   const std::vector<std::string>& values) {
  std::vector<PlotSeries> lines;
  for (const std::string& value : values) {
    for (PlotSeries& line : series_of(
             results, {"flow", {{"shape", shape}}, "shape", "seconds", value}, false, false)) {
      line.name = (*results.column("flow", value))["label"];
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

/// Stacked bars of a value of the phases, one bar for each shape.
Plot phase_bars(const Results& results, const std::string& value, const std::string& title) {
  const Json* column = results.column("phases", value);
  const std::string unit = column != nullptr ? (*column)["unit"].get<std::string>() : "";
  Plot plot{.id = "phases_" + value,
            .title = title,
            .x = {"what falls", false},
            .y = {unit.empty() ? "share of a step" : unit + " a step", false}};
  if (column == nullptr) return plot;
  const auto rows = results.rows("phases");
  const auto shapes = distinct(rows, "shape");
  for (const Json& shape : shapes) plot.categories.push_back(key_text(shape));
  for (const Json& phase : distinct(rows, "phase")) {
    PlotSeries series{.name = key_text(phase)};
    series.y_value = value;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const Json* row = results.row("phases", {{"shape", shapes[i]}, {"phase", phase}});
      if (row == nullptr || !row->contains(value)) continue;
      series.points.push_back({static_cast<double>(i), value_of(*row, value),
                               shown(*row, *column) + " " + unit, (*row)["id"]});
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

void show_phases(const Results& results, ReportPage& page) {
  if (results.rows("phases").empty()) return;
  page.heading("A simulation that embeds winnow: where the time of a step goes");
  page.paragraph(
      "Spheres and boxes fall through a funnel made of triangles, with soft contacts and friction. "
      "Handing over poses: telling winnow where bodies are now. "
      "Broad phase: which boxes overlap. Mid phase: which triangles of the funnel each body "
      "meets. Narrow phase: contact points. Solver: forces and motion, which are the simulation's "
      "own.");
  page.add({phase_bars(results, "ms", "a step by phases"),
            phase_bars(results, "share", "shares of the phases")});
  page.command((*results.rows("phases").front())["command"]);
  page.add(pivot(results, {"phases", Json::object(), "phase", "shape", "ms", "ms a step", false}));
  page.add(pivot(results, {"phases", Json::object(), "phase", "shape", "share", "", false}));
}

void show_pipeline(const Results& results, ReportPage& page) {
  show_whole_scenes(results, page);
  show_flows(results, page);
  for (const char* table : {"whole_scenes", "scene_ratios", "scene_levels", "tori", "mesh_builds",
                            "phases", "flows", "flow"}) {
    page.all_rows(table);
  }
}

}  // namespace

void show_flows(const Results& results, ReportPage& page) {
  show_phases(results, page);
  const auto rows = results.rows("flow");
  if (!rows.empty()) {
    page.heading("Energy and penetration over time");
    page.paragraph(
        "Friction and dampers take energy away, and gravity only turns one kind into another: the "
        "total, without what is added where bodies that left the funnel are put back above it, "
        "must never rise. Penetration shows how soft the contacts are; a sudden peak would be a "
        "contact that was found too late.");
    std::vector<Plot> plots;
    for (const Json& shape : distinct(rows, "shape")) {
      Plot plot{.id = "flow_energy_" + key_text(shape),
                .title = "energy, " + key_text(shape),
                .x = {"simulated time, s", false},
                .y = {"energy (density 1, edges about 1, gravity 10)", false}};
      plot.series = flow_lines(results, shape, {"kinetic", "potential", "elastic", "balance"});
      plots.push_back(std::move(plot));
    }
    for (const auto& [value, label] :
         {std::pair{"deepest", "deepest penetration, edges of a body"},
          std::pair{"pairs", "touching pairs"}, std::pair{"elastic", "energy in contacts"}}) {
      Plot plot{.id = std::string("flow_") + value,
                .title = label,
                .x = {"simulated time, s", false},
                .y = {label, false}};
      plot.series =
          series_of(results, {"flow", Json::object(), "shape", "seconds", value}, false, false);
      plots.push_back(std::move(plot));
    }
    page.add(plots);
    page.command((*rows.front())["command"]);
    for (const char* value : {"rise", "deepest"}) {
      page.add(pivot(results, {"flows", Json::object(), "shape", "steps", value}));
    }
  }
}

const ReportSection kPipelineSection{"pipeline", "Pipeline", declare_pipeline, plan_pipeline,
                                     show_pipeline};

}  // namespace winnow::bench
