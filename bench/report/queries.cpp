#include "bench/common/table.h"
#include "bench/report/section.h"
#include "bench/rows/query_rows.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace winnow::bench {
namespace {

/// Where nothing was asked for: sizes that are all alike, and sizes that are not.
std::vector<NamedScene> queries_scenes(const ReportOptions& options) {
  std::vector<std::string> names;
  for (const NamedScene& scene : options.scenes) names.push_back(scene.name);
  std::vector<NamedScene> scenes = options.scenes;
  if (names == main_scenes()) {
    std::erase_if(scenes, [](const NamedScene& scene) {
      return scene.name != "uniform" && scene.name != "mixed";
    });
  }
  return scenes;
}

std::vector<ReportStep> plan_queries(const ReportOptions& options) {
  const std::size_t objects = objects_up_to(options, 100'000);
  std::vector<ReportStep> steps;
  const auto add = [&](const NamedScene& scene, std::size_t rays, int threads,
                       const std::string& partition) {
    const QueryMeasureOptions asked{.objects = objects,
                                    .seed = options.seed,
                                    .partitions = {partition},
                                    .threads = threads,
                                    .rays = rays,
                                    .rounds = options.quick ? 2U : 5U,
                                    .machine_clock = false,
                                    .peers = options.peers};
    const double partitions = partition == "all" ? 9.0 : 2.0;
    steps.push_back({scene.name + ", " + threads_text(threads),
                     1e-4 * partitions * static_cast<double>(rays),
                     [=](Results& results) { add_queries(results, scene, asked); }});
  };
  const auto scenes = queries_scenes(options);
  for (const NamedScene& scene : scenes) {
    const bool is_first = &scene == &scenes.front();
    const std::size_t rays = options.quick ? 100 : is_first ? 10'000 : 5'000;
    add(scene, rays, 1, "all");
    const int most = options.threads.back();
    if (most != 1 && is_first) add(scene, rays, most, "LinearBvh");
  }
  const bool all_recorded = std::all_of(scenes.begin(), scenes.end(),
                                        [](const NamedScene& one) { return one.is_recording(); });
  if (!all_recorded) {
    steps.push_back({"frusta", 1.0, [objects, quick = options.quick](Results& results) {
                       add_frusta(results, objects, quick ? 2 : 15);
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
      const std::string caption =
          std::string("ns a question, ") + how + ", " + threads_text(threads.get<int>());
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
