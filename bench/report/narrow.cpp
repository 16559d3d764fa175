#include "bench/report/section.h"
#include "bench/rows/accuracy_rows.h"

#include <array>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

constexpr std::size_t kNarrowRacePairs = 8192;
constexpr std::array<double, 5> kNarrowRatios{1.0, 1e2, 1e4, 1e6, 1e8};
constexpr std::array<double, 4> kNarrowOffsets{1.0, 1e3, 1e6, 1e9};

/// Kinds of which curves are drawn: something round, something flat, something large.
bool has_curves(const PairKind& kind) {
  return kind.name == "sphere-box" || kind.name == "box-box" || kind.name == "hull16-hull16";
}

/// False where the library was built without qhull.
bool narrow_has_hulls() {
  ShapePool pool;
  ShapeId id;
  const Eigen::Vector3d point = Eigen::Vector3d::Zero();
  return pool.add_hull(std::span(&point, 1), 0.0, id) == Status::ok;
}

std::vector<PairKind> narrow_kinds(bool quick) {
  const bool hulls = narrow_has_hulls();
  std::vector<PairKind> kinds;
  for (const PairKind& kind : pair_kinds()) {
    const bool is_quick = kind.name == "sphere-box" || kind.name == "box-box";
    if ((is_quick || !quick) && (hulls || kind.hull_vertices == 0)) kinds.push_back(kind);
  }
  return kinds;
}

void declare_narrow(Results& results) {
  declare_pair_times(results);
  declare_pair_errors(results);
  const std::string of = "errors of such pairs by ";
  declare_error_curve(results, "narrow_gap", "narrow", of + "|distance| over their size",
                      {"kind", "engine", "gap"});
  declare_error_curve(results, "narrow_ratio", "narrow",
                      of + "the size of the second shape over that of the first",
                      {"kind", "engine", "ratio"});
  declare_error_curve(results, "narrow_offset", "narrow",
                      of + "the offset from the origin along each axis",
                      {"kind", "engine", "offset"});
}

void measure_narrow_times(Results& results, const ReportOptions& options, const PairKind& kind) {
  NarrowMeasureOptions asked{.kind = kind,
                             .pairs = options.quick ? 512 : kNarrowRacePairs,
                             .tiers = {NarrowTier::robust, NarrowTier::fast, NarrowTier::reference},
                             .peers = options.peers,
                             .seed = options.seed};
  asked.race.rounds = options.quick ? 3 : 5;
  if (options.quick) asked.race.turn_ms = 0.5;
  if (options.quick) asked.race.smallest_part = 128;
  add_pair_times(results, asked);
}

/// The oracle takes milliseconds a pair of hulls.
std::size_t judged_pairs(const PairKind& kind, bool quick) {
  if (kind.hull_vertices > 16) return quick ? 4 : 60;
  if (kind.hull_vertices > 0) return quick ? 10 : 500;
  return quick ? 60 : 2000;
}

AccuracyOptions narrow_accuracy_of(const ReportOptions& options, const PairKind& kind) {
  AccuracyOptions asked{.kind = kind, .peers = options.peers, .runs = 5};
  asked.set.pairs = judged_pairs(kind, options.quick);
  asked.set.seed = options.seed;
  return asked;
}

void measure_narrow_errors(Results& results, const ReportOptions& options, const PairKind& kind) {
  AccuracyOptions asked = narrow_accuracy_of(options, kind);
  asked.levels = {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold};
  add_pair_errors(results, asked, has_curves(kind));
}

void measure_narrow_curve(Results& results, const ReportOptions& options, const PairKind& kind,
                          const std::string& parameter, double value) {
  AccuracyOptions asked = narrow_accuracy_of(options, kind);
  asked.set.pairs = options.quick ? asked.set.pairs / 2 : kind.hull_vertices > 0 ? 100 : 400;
  if (parameter == "ratio") {
    asked.set.ratio = value;
  } else {
    asked.set.offset = value;
  }
  asked.runs = 1;
  add_error_curve(results, "narrow_" + parameter, {{"kind", kind.name}, {parameter, value}}, asked);
}

void add_curve_steps(std::vector<ReportStep>& steps, const ReportOptions& options,
                     const PairKind& kind) {
  const auto add = [&](const std::string& parameter, double value) {
    steps.push_back({std::string(kind.name) + ", " + parameter + " " + key_text(value),
                     options.quick ? 0.02 : 0.3, [=](Results& results) {
                       measure_narrow_curve(results, options, kind, parameter, value);
                     }});
  };
  for (const double ratio : kNarrowRatios) add("ratio", ratio);
  for (const double offset : kNarrowOffsets) add("offset", offset);
}

std::vector<ReportStep> plan_narrow(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  const std::vector<PairKind> kinds = narrow_kinds(options.quick);
  for (const PairKind& kind : kinds) {
    const std::string name(kind.name);
    const double hull = kind.hull_vertices;
    steps.push_back({"time of " + name, options.quick ? 0.1 : hull * 0.07 + 0.8,
                     [=](Results& results) { measure_narrow_times(results, options, kind); }});
  }
  for (const PairKind& kind : kinds) {
    const std::string name(kind.name);
    const double hull = kind.hull_vertices;
    steps.push_back({"errors of " + name, options.quick ? 0.05 : hull * 0.02 + 0.5,
                     [=](Results& results) { measure_narrow_errors(results, options, kind); }});
  }
  for (const PairKind& kind : kinds) {
    if (has_curves(kind)) add_curve_steps(steps, options, kind);
  }
  return steps;
}

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
  page.command_of("narrow_speed", {{"kind", "box-box"}});
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
  page.command_of("narrow_offset", {{"kind", "box-box"}});
  for (const NarrowCurve& curve : kNarrowCurves) page.all_rows(curve.table);
}

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
    page.command_of("narrow_error", {{"kind", "box-box"}});
    page.all_rows("narrow_error");
    page.heading("Kind by kind");
    show_each_kind(results, page);
  }
  show_times(results, page);
  show_narrow_curves(results, page);
}

}  // namespace

const ReportSection kNarrowSection{"narrow", "Speed against error: narrow phase", declare_narrow,
                                   plan_narrow, show_narrow};

}  // namespace winnow::bench
