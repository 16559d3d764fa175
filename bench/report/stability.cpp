#include "bench/questions/hard_case_files.h"
#include "bench/report/section.h"
#include "bench/rows/accuracy_rows.h"
#include "bench/rows/hard_case_rows.h"

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

void declare_stability(Results& results) {
  declare_hard_cases(results);
  declare_error_curve(
      results, "stability_curves", "stability",
      "errors of pairs, half of which are nearly touching, that get harder and harder",
      {"curve", "kind", "engine", "parameter"});
}

void measure_hard_cases(Results& results, bool peers) {
  for (const HardCaseFile& file : hard_case_files()) {
    add_hard_cases(results, file.family, Json::parse(file.json), peers);
  }
  add_hard_case_totals(results);
}

/// What gets harder, on which kinds of pairs.
struct StabilityCurve {
  const char* name;
  std::vector<const char*> kinds;
  double first;
  double last;
  void (*set)(PairSetOptions&, double);
};

const std::vector<StabilityCurve>& stability_curves() {
  static const std::vector<StabilityCurve> all{
      {"angle",
       {"capsule-capsule", "box-box"},
       1.0,
       1e-15,
       [](PairSetOptions& set, double value) { set.angle = value; }},
      {"ratio",
       {"sphere-box", "box-box"},
       1.0,
       1e12,
       [](PairSetOptions& set, double value) { set.ratio = value; }},
      {"offset",
       {"sphere-box", "box-box"},
       1.0,
       1e12,
       [](PairSetOptions& set, double value) { set.offset = value; }},
      {"thinness",
       {"sphere-triangle", "triangle-triangle"},
       1.0,
       1e-12,
       [](PairSetOptions& set, double value) { set.thinness = value; }}};
  return all;
}

void measure_stability(Results& results, const ReportOptions& options, const StabilityCurve& curve,
                       const PairKind& kind) {
  const int sign = curve.last < curve.first ? -1 : 1;
  const int powers = static_cast<int>(std::lround(std::abs(std::log10(curve.last))));
  for (int power = 0; power <= powers; power += options.quick ? 6 : 1) {
    const double value = std::stod("1e" + std::to_string(sign * power));
    AccuracyOptions asked{.kind = kind, .peers = options.peers, .runs = 1};
    asked.set.pairs = options.quick ? 16 : 200;
    asked.set.seed = options.seed;
    curve.set(asked.set, value);
    add_error_curve(results, "stability_curves",
                    {{"curve", curve.name}, {"kind", kind.name}, {"parameter", value}}, asked);
  }
}

std::vector<ReportStep> plan_stability(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  steps.push_back({"hard cases", options.peers ? 1.0 : 0.1,
                   [=](Results& results) { measure_hard_cases(results, options.peers); }});
  for (const StabilityCurve& curve : stability_curves()) {
    for (const char* name : curve.kinds) {
      const PairKind& kind = *find_pair_kind(name);
      steps.push_back({std::string(curve.name) + ", " + name, options.quick ? 0.05 : 1.0,
                       [&curve, &kind, options](Results& results) {
                         measure_stability(results, options, curve, kind);
                       }});
    }
  }
  return steps;
}

/// Families down, engines across: how many are wrong.
PageTable hard_case_table(const Results& results) {
  PageTable table;
  const auto rows = results.rows("hard_cases");
  const std::vector<Json> engines = distinct(rows, "engine");
  table.caption = "cases that are wrong";
  table.header = {"family"};
  for (const Json& engine : engines) table.header.push_back(key_text(engine));
  for (const Json& family : distinct(rows, "family")) {
    std::vector<PageCell> cells{text_cell(key_text(family))};
    for (const Json& engine : engines) {
      const Json* row = results.row("hard_cases", {{"family", family}, {"engine", engine}});
      const bool asked = row != nullptr && value_of(*row, "right") + value_of(*row, "wrong") > 0.0;
      cells.push_back(asked ? cell(results, "hard_cases", row, "wrong") : text_cell("not taken"));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

void show_hard_cases(const Results& results, ReportPage& page) {
  if (results.rows("hard_cases").empty()) return;
  page.paragraph(
      "Hard cases are small questions whose answers are known by reasoning: shapes that touch, lie "
      "in one plane, are flat, thin, tiny, huge or far away, and bugs that other projects have "
      "been told of. A case is wrong if the verdict is, if the distance is off by more than is "
      "allowed, or if there is no unit normal or it is off by more than 0.01 degrees. winnow's "
      "tiers are held to what they promise, other libraries to what the tier fast promises (an "
      "error of 1e-4 of the size); what they have no way to be asked is not taken.");
  page.add(pivot(results, {"hard_cases_all", Json::object(), "engine", "answer", "cases",
                           "hard cases of all families", false}));
  page.add(hard_case_table(results));
  page.add(
      pivot(results, {"hard_cases", Json::object(), "family", "engine", "worst_over_allowed",
                      "worst error of a distance over what is allowed: above 1 is wrong", false}));
  page.command_of("hard_cases", {{"family", "touching"}});
  page.all_rows("hard_cases");
  page.all_rows("hard_cases_all");
}

struct CurveText {
  const char* name;
  const char* axis;
};
constexpr std::array<CurveText, 4> kCurveTexts{
    {{"angle", "angle between the bodies' axes, rad"},
     {"ratio", "size of the second shape over that of the first"},
     {"offset", "offset from the origin along each axis, about sizes"},
     {"thinness", "height of triangles over that of random ones"}}};

std::vector<Plot> curve_plots(const Results& results, const CurveText& curve) {
  std::vector<Plot> plots;
  const auto rows = results.rows("stability_curves", {{"curve", curve.name}});
  for (const Json& kind : distinct(rows, "kind")) {
    const Json where{{"curve", curve.name}, {"kind", kind}};
    const std::string name = std::string(curve.name) + "_" + key_text(kind);
    Plot errors{.id = "stability_" + name,
                .title = key_text(kind) + ": worst error against " + curve.name,
                .x = {curve.axis, true},
                .y = {"worst error / (size + |distance|), none as 1e-17", true}};
    errors.series = series_of(
        results, {"stability_curves", where, "engine", "parameter", "worst_error_or_floor"}, true,
        true);
    plots.push_back(std::move(errors));
    Plot wrong{.id = "stability_wrong_" + name,
               .title = key_text(kind) + ": wrong verdicts against " + curve.name,
               .x = {curve.axis, true},
               .y = {"wrong verdicts", false}};
    wrong.series = series_of(results, {"stability_curves", where, "engine", "parameter", "wrong"},
                             true, false);
    plots.push_back(std::move(wrong));
  }
  return plots;
}

void show_stability(const Results& results, ReportPage& page) {
  show_hard_cases(results, page);
  if (results.rows("stability_curves").empty()) return;
  page.heading("Where a kernel starts to fail");
  page.paragraph(
      "Random pairs, half of them nearly touching, that get harder from one end of the axis to the "
      "other: the worst error of the signed distance, and how many verdicts are wrong. A flat line "
      "is a kernel that does not mind; one that climbs loses digits, and where a line ends there "
      "are no finite distances at all any more (column missing). Angle: the second body stands as "
      "the first but for a "
      "small turn, so that edges are nearly parallel and their cross products next to nothing. "
      "Ratio: a small shape at a large one, where an error that is small beside the large one "
      "exceeds the small one, and verdicts are lost. Offset: the same pairs, moved as a whole. "
      "Thinness: needle triangles.");
  for (const CurveText& curve : kCurveTexts) page.add(curve_plots(results, curve));
  page.command_of("stability_curves", {{"curve", "angle"}, {"kind", "box-box"}});
  page.all_rows("stability_curves");
}

}  // namespace

const ReportSection kStabilitySection{"stability", "Numerical stability", declare_stability,
                                      plan_stability, show_stability};

}  // namespace winnow::bench
