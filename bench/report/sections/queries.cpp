#include "engine/fingerprint.h"
#include "queries/query_costs.h"
#include "report/scene_words.h"
#include "report/section.h"
#include "tool/arguments.h"
#include "tool/measure_queries.h"
#include "tool/table.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace winnow::bench {
namespace {

constexpr const char* kReading = "reading all boxes once";

void declare_queries(Results& results) {
  results.declare({"queries",
                   "queries",
                   "questions to objects of a scene",
                   {"scene", "objects", "set", "engine", "asked", "threads"},
                   {{"ns", "time", "ns/question", Better::less},
                    {"found", "objects found", "a question", Better::neither},
                    {"kind", "kind", "", Better::neither, Format::text},
                    {"questions", "questions", "", Better::neither, Format::count},
                    {"wrong", "wrong answers", "", Better::less, Format::count},
                    {"undecided", "undecided in float", "", Better::neither, Format::count},
                    {"fingerprint", "answers", "", Better::neither, Format::text}}});
  results.declare({"frusta",
                   "queries",
                   "a frustum beside reading every box",
                   {"objects", "set", "engine"},
                   {{"ms", "a frustum", "ms", Better::less},
                    {"found", "objects found", "a frustum", Better::neither}}});
}

/// What one step measures.
struct QueriesCell {
  ReportOptions options{};
  ReportScene scene{};
  std::size_t objects = 0;
  std::size_t rays = 0;
  int threads = 1;
  std::string partition = "all";

  [[nodiscard]] std::size_t rounds() const { return options.quick ? 2 : 5; }
  void measure(Results& results) const;
  [[nodiscard]] std::string command(const QueryRun& run, bool is_peer) const;
};

std::string QueriesCell::command(const QueryRun& run, bool is_peer) const {
  std::string text = "bench/run queries";
  text += (scene.recording ? " --recording " : " --scene ") + shell_word(scene.argument);
  if (!scene.recording) text += " --objects " + std::to_string(objects);
  return text + " --set \"" + run.set + "\" --partition " + (is_peer ? "LinearBvh" : run.engine) +
         " --threads " + std::to_string(threads) + " --rays " + std::to_string(rays) +
         " --rounds " + std::to_string(rounds()) + " --seed " + std::to_string(options.seed) +
         " --isa " + isa_name();
}

/// Sets of one kind differ in how much they find.
std::string query_kind_of(const std::string& set) {
  if (set == "ray any") return set;
  return set.substr(0, set.find(' '));
}

Json query_row_of(const QueryRun& run) {
  const auto questions = static_cast<double>(run.questions);
  std::vector<double> ns;
  for (const double ms : run.ms) ns.push_back(1e6 * ms / questions);
  return {{"set", run.set},
          {"engine", run.engine},
          {"asked", run.asking == Asking::single ? "single" : "batch"},
          {"threads", run.threads},
          {"ns", to_value(ns)},
          {"found", run.found_a_question()},
          {"kind", query_kind_of(run.set)},
          {"questions", run.questions},
          {"wrong", run.comparison.wrong},
          {"undecided", run.comparison.undecided},
          {"fingerprint", to_hex(run.fingerprint)}};
}

void QueriesCell::measure(Results& results) const {
  QueryMeasureOptions asked;
  asked.scene = scene.argument;
  asked.recording = scene.recording.get();
  asked.objects = objects;
  asked.seed = options.seed;
  asked.partitions = {partition};
  asked.threads = threads;
  asked.rays = rays;
  asked.rounds = rounds();
  asked.peers = options.peers;
  asked.machine_clock = false;
  const QueryMeasurement measured = measure_queries(asked);
  std::string problems;
  for (const QueryRun& run : measured.runs) {
    if (!run.answered()) {
      problems += "; " + run.engine + " refused " + run.set + ": " + run.refusal;
      continue;
    }
    if (!run.comparison.agree()) {
      problems += "; " + run.engine + ", " + run.set + ": " + run.comparison.first;
    }
    Json row = query_row_of(run);
    row.update({{"scene", scene.name},
                {"objects", measured.objects},
                {"command", command(run, measured.is_peer(run))}});
    results.add("queries", std::move(row));
  }
  if (!problems.empty()) throw std::runtime_error(problems.substr(2));
}

void measure_frusta(Results& results, std::size_t objects, bool quick) {
  const std::vector<std::string> partitions{"LinearBvh", "FlatGrid", "BoundsNSquared"};
  for (const char* set : {"frustum 1%", "frustum 50%"}) {
    const FrustumCosts costs = measure_frustum_costs(partitions, set, objects, quick ? 2 : 15);
    const auto add = [&](const std::string& engine, const std::vector<double>& ms) {
      results.add("frusta", {{"objects", objects},
                             {"set", set},
                             {"engine", engine},
                             {"ms", to_value(ms)},
                             {"found", costs.found_a_question},
                             {"command", "bench/run goals --topic queries"}});
    };
    for (std::size_t i = 0; i < partitions.size(); ++i) add(partitions[i], costs.asked[i]);
    add(kReading, costs.read);
  }
}

/// Where nothing was asked for: sizes that are all alike, and sizes that are not.
std::vector<ReportScene> queries_scenes(const ReportOptions& options) {
  std::vector<std::string> names;
  for (const ReportScene& scene : options.scenes) names.push_back(scene.name);
  std::vector<ReportScene> scenes = options.scenes;
  if (names == main_scenes()) {
    std::erase_if(scenes, [](const ReportScene& scene) {
      return scene.name != "uniform" && scene.name != "mixed";
    });
  }
  return scenes;
}

std::vector<ReportStep> plan_queries(const ReportOptions& options) {
  const std::size_t objects = objects_up_to(options, 100'000);
  std::vector<ReportStep> steps;
  const auto add = [&](const QueriesCell& cell) {
    const double partitions = cell.partition == "all" ? 9.0 : 2.0;
    const std::string what = cell.scene.name + ", " + std::to_string(cell.threads) +
                             (cell.threads == 1 ? " thread" : " threads");
    steps.push_back({what, 1e-4 * partitions * static_cast<double>(cell.rays),
                     [cell](Results& results) { cell.measure(results); }});
  };
  const auto scenes = queries_scenes(options);
  for (const ReportScene& scene : scenes) {
    QueriesCell cell{.options = options, .scene = scene, .objects = objects};
    cell.rays = options.quick ? 100 : steps.empty() ? 10'000 : 5'000;
    add(cell);
    if (options.threads.back() == 1 || &scene != &scenes.front()) continue;
    cell.threads = options.threads.back();
    cell.partition = "LinearBvh";
    add(cell);
  }
  const bool all_recorded = std::all_of(scenes.begin(), scenes.end(), [](const ReportScene& one) {
    return one.recording != nullptr;
  });
  if (!all_recorded) {
    steps.push_back({"frusta", 1.0, [objects, quick = options.quick](Results& results) {
                       measure_frusta(results, objects, quick);
                     }});
  }
  return steps;
}

/// Nanoseconds a question against how much it finds. Only boxes are one question of several sizes,
/// joined by lines.
std::vector<Plot> queries_plots(const Results& results, const Json& scene) {
  std::vector<Plot> plots;
  for (const auto& [kind, asked, what] : {std::tuple{"box", "single", "boxes, one at a time"},
                                          std::tuple{"box", "batch", "boxes, in batches"},
                                          std::tuple{"ray", "single", "rays, one at a time"},
                                          std::tuple{"ray", "batch", "rays, in batches"}}) {
    Plot plot{.id = "queries_" + key_text(scene) + "_" + kind + "_" + asked,
              .title = key_text(scene) + ": " + what,
              .x = {"objects found a question", true},
              .y = {"ns a question", true}};
    plot.series = series_of(results,
                            {"queries",
                             {{"scene", scene}, {"kind", kind}, {"asked", asked}, {"threads", 1}},
                             "engine",
                             "found",
                             "ns",
                             kind == std::string("box")},
                            true, true);
    for (PlotSeries& series : plot.series) {
      std::stable_sort(series.points.begin(), series.points.end(),
                       [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
    }
    plots.push_back(std::move(plot));
  }
  return plots;
}

void show_queries_of(const Results& results, const Json& scene, ReportPage& page) {
  const auto rows = results.rows("queries", {{"scene", scene}});
  page.heading("Questions to " + key_text(scene) + ", " +
               shown((*rows.front())["objects"].get<double>(), "count") + " objects");
  page.add(queries_plots(results, scene));
  page.command((*rows.front())["command"]);
  for (const Json& threads : distinct(rows, "threads")) {
    for (const auto& [asked, how] :
         {std::pair{"single", "one at a time"}, std::pair{"batch", "in batches"}}) {
      const std::string caption = std::string("ns a question, ") + how + ", " + key_text(threads) +
                                  (threads == 1 ? " thread" : " threads");
      page.add(pivot(results, {"queries",
                               {{"scene", scene}, {"threads", threads}, {"asked", asked}},
                               "engine",
                               "set",
                               "ns",
                               caption}));
    }
  }
  page.add(pivot(results, {"queries",
                           {{"scene", scene}, {"threads", 1}, {"asked", "single"}},
                           "engine",
                           "set",
                           "found",
                           "objects found a question"}));
}

void show_queries(const Results& results, ReportPage& page) {
  const auto rows = results.rows("queries");
  if (!rows.empty()) {
    page.paragraph(
        "Rays, boxes, balls, frusta, swept volumes and nearest objects, on one frame. Boxes are 1, "
        "5 and 20 mean edges of the objects wide, a ball 5; a near ray is 10 long; frusta see 1 % "
        "or 50 % of everything. Where a box finds few "
        "objects, its time is the price of asking; where it finds many, that of handing them "
        "over. Answers are compared one by one: a wrong one is a "
        "problem at the top of this page; \"undecided\" counts those that lie within the rounding "
        "of a library that computes in float.");
    for (const Json& scene : distinct(rows, "scene")) show_queries_of(results, scene, page);
  }
  if (!results.rows("frusta").empty()) {
    page.heading("Frusta beside reading every box");
    page.paragraph(
        "A frustum that holds a hundredth of the objects should cost much less than a look at all "
        "of them, one that holds half of them not much more.");
    page.add(pivot(results, {"frusta", Json::object(), "engine", "set", "ms", "ms", false}));
  }
  for (const char* table : {"queries", "frusta"}) page.all_rows(table);
}

}  // namespace

const ReportSection kQueriesSection{"queries", "Queries", declare_queries, plan_queries,
                                    show_queries};

}  // namespace winnow::bench
