#include "report/sections/pipeline.h"
#include "tool/measure_pipeline.h"
#include "tool/table.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace winnow::bench {
namespace {

constexpr const char* kMovingText = "moving a little";
constexpr const char* kRestingText = "at rest";
constexpr std::pair<const char*, ContactLevel> kSceneLevels[] = {
    {"pairs", ContactLevel::pairs},
    {"boolean", ContactLevel::boolean},
    {"distance", ContactLevel::distance},
    {"manifold", ContactLevel::manifold}};

/// The races on one scene.
struct SceneCell {
  ReportOptions options{};
  std::string scene{};
  std::size_t bodies = 0;  ///< 0: as many as suit it

  void measure(Results& results) const;
  [[nodiscard]] std::size_t frames() const { return options.quick ? 2 : 5; }

 private:
  [[nodiscard]] PipelineMeasureOptions race(const BodySet& set) const;
  [[nodiscard]] std::string command(const std::string& level, const std::string& threads) const;
  void add_race(Results& results, const PipelineMeasurement& measured, const char* motion) const;
  void add_levels(Results& results, const BodySet& set) const;
};

PipelineMeasureOptions SceneCell::race(const BodySet& set) const {
  PipelineMeasureOptions how;
  how.scene = scene;
  how.set = &set;
  how.threads = options.threads;
  how.frames = frames();
  how.seed = options.seed;
  how.machine_clock = false;
  return how;
}

std::string SceneCell::command(const std::string& level, const std::string& threads) const {
  std::string text = "bench/run pipeline --scene " + scene + " --level " + level + " --threads " +
                     threads + " --frames " + std::to_string(frames()) + " --seed " +
                     std::to_string(options.seed) + " --isa " + isa_name();
  if (bodies != 0) text += " --bodies " + std::to_string(bodies);
  return text;
}

void SceneCell::add_race(Results& results, const PipelineMeasurement& measured,
                         const char* motion) const {
  std::string threads;
  for (const int count : options.threads) {
    threads += (threads.empty() ? "" : ",") + std::to_string(count);
  }
  std::vector<Json> rows;
  for (const SceneTiming& timing : measured.timings) {
    const bool is_peer = std::find(measured.peers.begin(), measured.peers.end(), timing.engine) !=
                         measured.peers.end();
    rows.push_back({{"scene", scene},
                    {"motion", motion},
                    {"engine", is_peer ? timing.engine : "winnow"},
                    {"threads", timing.threads},
                    {"ms", to_value(timing.ms)},
                    {"touching", timing.finds.touching},
                    {"points", timing.finds.points},
                    {"bodies", measured.bodies},
                    {"triangles", measured.triangles},
                    {"command", command("manifold", threads)}});
    rows.back()["id"] = results.add("whole_scenes", rows.back());
  }
  for (const Json& row : rows) {
    const Json& first = rows.front();
    if (&row == &first) continue;
    results.add("scene_ratios",
                {{"scene", scene},
                 {"motion", motion},
                 {"engine", row["engine"]},
                 {"threads", row["threads"]},
                 {"ratio", value_of(row, "ms") / value_of(first, "ms")},
                 {"from", derived("ratio", "ratio", "ms", {row["id"], first["id"]})}});
  }
}

void SceneCell::add_levels(Results& results, const BodySet& set) const {
  for (const auto& [name, level] : kSceneLevels) {
    PipelineMeasureOptions how = race(set);
    how.level = level;
    how.threads = {1};
    how.peers = false;
    const PipelineMeasurement measured = measure_pipeline(how);
    const SceneTiming& timing = measured.timings.front();
    results.add("scene_levels", {{"scene", scene},
                                 {"level", name},
                                 {"ms", to_value(timing.ms)},
                                 {"touching", timing.finds.touching},
                                 {"points", timing.finds.points},
                                 {"command", command(name, "1")}});
  }
}

void SceneCell::measure(Results& results) const {
  const std::unique_ptr<BodySet> set = make_pipeline_scene(scene, bodies, options.seed);
  for (const bool resting : {false, true}) {
    PipelineMeasureOptions how = race(*set);
    how.resting = resting;
    how.peers = options.peers;
    add_race(results, measure_pipeline(how), resting ? kRestingText : kMovingText);
  }
  add_levels(results, *set);
}

void measure_tori(Results& results, std::size_t rounds, bool peers) {
  const MeshMeasurement measured = measure_meshes(rounds, peers, false);
  const std::string again =
      "bench/run pipeline --scene tori --frames " + std::to_string(rounds) + " --isa " + isa_name();
  for (const MeshTiming& timing : measured.timings) {
    results.add("mesh_builds", {{"engine", timing.engine},
                                {"ms", to_value(timing.build_ms)},
                                {"bytes_per_triangle", timing.bytes_per_triangle},
                                {"command", again}});
    for (std::size_t p = 0; p < torus_poses().size(); ++p) {
      results.add("tori", {{"pose", p + 1},
                           {"engine", timing.engine},
                           {"ms", to_value(timing.collide_ms[p])},
                           {"pairs", timing.pairs[p]},
                           {"differ", timing.differ[p]},
                           {"command", again}});
    }
  }
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

}  // namespace

void declare_whole_scenes(Results& results) {
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
  results.declare({"scene_levels",
                   "pipeline",
                   "a frame by how much is asked for",
                   {"scene", "level"},
                   {{"ms", "a frame", "ms", Better::less},
                    {"touching", "pairs reported", "", Better::neither, Format::count},
                    {"points", "contact points", "", Better::neither, Format::count}}});
  results.declare(
      {"tori",
       "pipeline",
       "all contacts of two tori of 20,000 triangles",
       {"pose", "engine"},
       {{"ms", "time by pose", "ms", Better::less},
        {"pairs", "touching triangles by pose", "", Better::neither, Format::count},
        {"differ", "pairs that not both found, by pose", "", Better::neither, Format::count}}});
  results.declare({"mesh_builds",
                   "pipeline",
                   "the tree of a torus",
                   {"engine"},
                   {{"ms", "build", "ms", Better::less},
                    {"bytes_per_triangle", "memory", "bytes/triangle", Better::less}}});
}

std::vector<ReportStep> plan_whole_scenes(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  const auto add = [&](const std::string& scene, std::size_t quick_bodies, double seconds) {
    const SceneCell cell{options, scene, options.quick ? quick_bodies : 0};
    const double known = options.peers ? seconds : 0.4 * seconds;
    steps.push_back(
        {scene, options.quick ? 0.2 : known, [cell](Results& results) { cell.measure(results); }});
  };
  add("pile", 200, 9.0);
  add("terrain", 40, 3.0);
  const std::size_t rounds = options.quick ? 2 : 5;
  steps.push_back({"tori", 0.6, [rounds, peers = options.peers](Results& results) {
                     measure_tori(results, rounds, peers);
                   }});
  return steps;
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

}  // namespace winnow::bench
