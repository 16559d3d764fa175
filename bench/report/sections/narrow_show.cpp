#include "report/sections/narrow_show.h"

#include "report/sections/accuracy_rows.h"

#include <array>

namespace winnow::bench {
namespace {

/// What is drawn against ns a pair at a level, and from how much on.
struct ErrorOf {
  const char* level;
  const char* value;
  const char* what;
  const char* axis;
};
constexpr const char* kOfTheSize = "error / (size + |distance|)";
constexpr std::array<ErrorOf, 9> kErrorPlots{
    {{"distance", "worst_distance_or_floor", "worst error of the distance", kOfTheSize},
     {"manifold", "worst_depth_or_floor", "worst error of the depth", kOfTheSize},
     {"distance", "worst_degrees_or_floor", "worst error of the normal", "degrees"},
     {"distance", "p99_distance", "99 % error of the distance", kOfTheSize},
     {"manifold", "p99_depth", "99 % error of the depth", kOfTheSize},
     {"distance", "p99_degrees", "99 % error of the normal", "degrees"},
     {"distance", "median_distance", "median error of the distance", kOfTheSize},
     {"manifold", "median_depth", "median error of the depth", kOfTheSize},
     {"distance", "median_degrees", "median error of the normal", "degrees"}}};

Plot speed_against_error(const Results& results, const ErrorOf& error, Json where,
                         const std::string& id, const std::string& title, bool front) {
  Plot plot{.id = id, .title = title, .x = {"ns a pair", true}, .y = {error.axis, true}};
  where["level"] = error.level;
  plot.series = series_of(
      results, {"narrow_error", std::move(where), "engine", "ns", error.value, false}, true, true);
  if (front) plot.series.push_back(pareto_front(plot.series));
  return plot;
}

void show_all_kinds(const Results& results, ReportPage& page) {
  std::vector<Plot> plots;
  for (const ErrorOf& error : kErrorPlots) {
    plots.push_back(speed_against_error(results, error, Json::object(),
                                        std::string("narrow_") + error.value,
                                        std::string(error.what) + ", level " + error.level, false));
  }
  page.add(plots);
}

void show_each_kind(const Results& results, ReportPage& page) {
  const ErrorOf all{"distance", "worst_error_or_floor", "", kOfTheSize};
  std::vector<Plot> plots;
  for (const Json& kind : distinct(results.rows("narrow_error"), "kind")) {
    const std::string name = key_text(kind);
    plots.push_back(speed_against_error(results, all, {{"kind", kind}}, "narrow_kind_" + name,
                                        name + ", worst of distance and depth", true));
  }
  page.add(plots);
}

void show_error_tables(const Results& results, ReportPage& page) {
  for (const char* level : {"boolean", "distance", "manifold"}) {
    page.add(pivot(results, {"narrow_error",
                             {{"level", level}},
                             "engine",
                             "kind",
                             "wrong",
                             std::string("wrong verdicts at level ") + level,
                             false}));
  }
  for (const char* level : {"distance", "manifold"}) {
    page.add(pivot(results, {"narrow_error",
                             {{"level", level}},
                             "engine",
                             "kind",
                             "missing",
                             std::string("answers without a distance or a normal at level ") +
                                 level + ", which no error counts",
                             false}));
  }
  for (const ErrorOf& error : kErrorPlots) {
    const std::string value = error.value;
    const std::size_t end = value.rfind("_or_floor");
    if (end == std::string::npos) continue;
    page.add(pivot(results, {"narrow_error",
                             {{"level", error.level}},
                             "engine",
                             "kind",
                             value.substr(0, end),
                             std::string(error.what) + ", level " + error.level}));
  }
}

/// Kinds down, levels across: the tier robust, and the fastest other library that is right.
PageTable table_of_times(const Results& results) {
  PageTable table;
  const auto rows = results.rows("narrow_speed", {{"engine", "robust"}});
  const std::vector<Json> levels = distinct(rows, "level");
  table.caption =
      "ns a pair: the tier robust, the fastest other library that is right, and their "
      "ratio";
  table.header = {"kind"};
  for (const Json& level : levels) {
    const std::string name = key_text(level);
    table.header.insert(table.header.end(), {name + ": robust", "best other", "ns", "ratio"});
  }
  for (const Json& kind : distinct(rows, "kind")) {
    std::vector<PageCell> cells{text_cell(key_text(kind))};
    for (const Json& level : levels) {
      const auto of = [&](const Json& engine) {
        const Json* row =
            results.row("narrow_speed", {{"kind", kind}, {"level", level}, {"engine", engine}});
        return cell(results, "narrow_speed", row, "ns");
      };
      const Json* best = results.row("narrow_best", {{"kind", kind}, {"level", level}});
      cells.push_back(of("robust"));
      cells.push_back(cell(results, "narrow_best", best, "best_peer"));
      cells.push_back(best == nullptr ? text_cell("-") : of((*best)["best_peer"]));
      cells.push_back(cell(results, "narrow_best", best, "speedup"));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

void show_times(const Results& results, ReportPage& page) {
  if (results.rows("narrow_speed").empty()) return;
  page.heading("What a pair costs");
  page.paragraph(
      "Random pairs, every second one overlapping; all that a caller needs is in the time: shapes "
      "and poses are gathered, answers are written. A library is right by and large if its "
      "verdicts differ from those of the tier robust in at most one of a hundred pairs, its depths "
      "in at most one of ten, and it finds at least half as many contacts.");
  page.add(table_of_times(results));
  for (const char* level : {"boolean", "distance", "manifold"}) {
    page.add(pivot(results, {"narrow_speed",
                             {{"level", level}},
                             "engine",
                             "kind",
                             "ns",
                             std::string(level) + ", ns a pair",
                             false}));
  }
  show_command(page, "narrow_speed", {{"kind", "box-box"}});
  page.all_rows("narrow_speed");
  page.all_rows("narrow_best");
}

struct NarrowCurve {
  const char* table;
  const char* parameter;
  const char* against;
  const char* axis;
};
constexpr std::array<NarrowCurve, 3> kNarrowCurves{
    {{"narrow_gap", "gap", "distance", "|distance| / size: from this to ten times as much"},
     {"narrow_ratio", "ratio", "size ratio", "size of the second shape over that of the first"},
     {"narrow_offset", "offset", "offset",
      "offset from the origin along each axis, lengths of about a shape"}}};

void show_narrow_curves(const Results& results, ReportPage& page) {
  std::vector<Plot> plots;
  for (const NarrowCurve& curve : kNarrowCurves) {
    for (const Json& kind : distinct(results.rows(curve.table), "kind")) {
      Plot plot{.id = std::string(curve.table) + "_" + key_text(kind),
                .title = key_text(kind) + ": worst error against " + curve.against,
                .x = {curve.axis, true},
                .y = {kOfTheSize, true}};
      plot.series = series_of(
          results,
          {curve.table, {{"kind", kind}}, "engine", curve.parameter, "worst_error_or_floor"}, true,
          true);
      plots.push_back(std::move(plot));
    }
  }
  if (plots.empty()) return;
  page.heading("Error against distance, sizes and offset");
  page.paragraph(
      "The worst error of the signed distance. winnow subtracts positions in double before it does "
      "anything else, so that its curves do not depend on where the pair stands; a library that "
      "computes in the world's axes loses about a digit with every power of ten, from where the "
      "steps between its numbers are no longer small beside the shapes.");
  page.add(plots);
  show_command(page, "narrow_offset", {{"kind", "box-box"}});
  for (const NarrowCurve& curve : kNarrowCurves) page.all_rows(curve.table);
}

}  // namespace

void show_narrow(const Results& results, ReportPage& page) {
  const auto rows = results.rows("narrow_error");
  if (!rows.empty()) {
    page.paragraph(
        "Each point is a kind of pair, answered by one of winnow's tiers or by another library, "
        "all on the same pairs: down is more exact, left is faster. Kind by kind further down, "
        "nothing is better in both than the points on the front. Half of the pairs overlap, and "
        "half are nearly touching, down to a millionth of their size. Errors are relative to size "
        "+ |distance|, judged by arithmetic of 100 digits where the tool was built with it (column "
        "judge), and normals count only where they are unique. Distances are of pairs apart, "
        "depths of pairs that overlap. An error of nothing is drawn at 1e-17 where the worst is "
        "shown, and left out elsewhere.");
    if (results.row("narrow_error", {{"engine", "FCL indep"}}) != nullptr) {
      page.paragraph(
          "Answers are what a library's functions return, brought to the same signs and axes where "
          "these differ (Bullet and FCL solve some pairs in the axes of the first shape).");
    }
    show_all_kinds(results, page);
    show_error_tables(results, page);
    show_command(page, "narrow_error", {{"kind", "box-box"}});
    page.all_rows("narrow_error");
    page.heading("Kind by kind");
    show_each_kind(results, page);
  }
  show_times(results, page);
  show_narrow_curves(results, page);
}

}  // namespace winnow::bench
