#include "query/hard_case_files.h"
#include "report/section.h"
#include "report/sections/accuracy_rows.h"
#include "report/sections/stability_show.h"
#include "tool/measure_hard_cases.h"

#include <array>
#include <cmath>
#include <utility>

namespace winnow::bench {
namespace {

void declare_stability(Results& results) {
  results.declare({"hard_cases",
                   "stability",
                   "cases whose answers are known by reasoning",
                   {"family", "engine"},
                   {{"right", "right", "cases", Better::more, Format::count},
                    {"wrong", "wrong", "cases", Better::less, Format::count},
                    {"wrong_verdicts", "of them verdicts", "cases", Better::less, Format::count},
                    {"not_taken", "not taken", "cases", Better::neither, Format::count},
                    {"worst_error", "worst error", "of the size", Better::less, Format::tiny},
                    {"worst_over_allowed", "worst error over what is allowed", "times",
                     Better::less, Format::tiny},
                    {"faults", "what was wrong", "", Better::neither, Format::text}}});
  results.declare({"hard_cases_all",
                   "stability",
                   "hard cases of all families",
                   {"engine", "answer"},
                   {{"cases", "cases", "", Better::neither, Format::count}}});
  results.declare({"stability_curves",
                   "stability",
                   "errors of pairs, half of which are nearly touching, that get harder and harder",
                   {"curve", "kind", "engine", "parameter"},
                   accuracy_curve_columns()});
}

/// Sums of the rows that are there.
void add_hard_case_totals(Results& results) {
  for (const Json& engine : distinct(results.rows("hard_cases"), "engine")) {
    const std::array<std::pair<const char*, const char*>, 4> answers{
        {{"right", "right"},
         {"wrong", "wrong"},
         {"wrong_verdicts", "of them verdicts"},
         {"not_taken", "not taken"}}};
    for (const auto& [value, name] : answers) {
      double sum = 0.0;
      std::vector<std::string> ids;
      for (const Json* row : results.rows("hard_cases", {{"engine", engine}})) {
        sum += value_of(*row, value);
        ids.push_back((*row)["id"]);
      }
      results.add("hard_cases_all", {{"engine", engine},
                                     {"answer", name},
                                     {"cases", sum},
                                     {"from", derived("cases", "sum", value, ids)}});
    }
  }
}

void measure_hard_cases(Results& results, const ReportOptions& options) {
  for (const HardCaseFile& file : hard_case_files()) {
    const std::string family = file.family;
    const std::string command = "bench/run query tests/hard_cases/" + family + ".json --judge";
    for (const HardCaseTally& one : judge_hard_cases(Json::parse(file.json), options.peers)) {
      results.add("hard_cases", {{"family", family},
                                 {"engine", one.engine},
                                 {"right", one.right},
                                 {"wrong", one.wrong},
                                 {"wrong_verdicts", one.wrong_verdicts},
                                 {"not_taken", one.not_taken},
                                 {"worst_error", one.worst_error},
                                 {"worst_over_allowed", one.worst_over_allowed},
                                 {"faults", one.wrong == 0 ? "-" : one.faults_text()},
                                 {"command", one.is_peer ? with_peers(command) : command}});
    }
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
    for (const Accuracy& one : measure_accuracy(asked).engines) {
      add_accuracy_row(results, "stability_curves",
                       {{"curve", curve.name},
                        {"kind", kind.name},
                        {"engine", one.engine},
                        {"parameter", value}},
                       one, asked);
    }
  }
}

std::vector<ReportStep> plan_stability(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  steps.push_back({"hard cases", options.peers ? 1.0 : 0.1,
                   [=](Results& results) { measure_hard_cases(results, options); }});
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

}  // namespace

const ReportSection kStabilitySection{"stability", "Numerical stability", declare_stability,
                                      plan_stability, show_stability};

}  // namespace winnow::bench
