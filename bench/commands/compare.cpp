// The command `winnow dev compare`: compares two reports (results.json) value by value and prints a
// summary for each table. The comparison itself is in report/compare.

#include "bench/report/compare.h"
#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/common/table.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

namespace winnow::bench {
namespace {

struct Compare {
  std::string old_path;
  std::string new_path;
  double threshold = CompareOptions{}.threshold;
  bool all = false;
  std::string scale = "auto";
  std::string json;

  void add_options(CLI::App& app);
  [[nodiscard]] int run() const;

 private:
  [[nodiscard]] double scale_of(const Results& before, const Results& after,
                                std::vector<std::string>& remarks) const;
};

/// Changes of one value of one table.
struct CompareSummary {
  std::string table;
  std::string value;
  std::vector<const Change*> changes;

  /// Geometric mean of the ratios that are neither zero nor infinite.
  [[nodiscard]] double geometric_mean() const {
    double sum = 0.0;
    std::size_t count = 0;
    for (const Change* change : changes) {
      if (!(change->ratio > 0.0) || std::isinf(change->ratio)) continue;
      sum += std::log(change->ratio);
      ++count;
    }
    return count == 0 ? 1.0 : std::exp(sum / static_cast<double>(count));
  }
  [[nodiscard]] auto extremes() const {
    return std::minmax_element(changes.begin(), changes.end(),
                               [](auto* a, auto* b) { return a->ratio < b->ratio; });
  }
  [[nodiscard]] std::size_t with(ChangeVerdict verdict) const {
    return static_cast<std::size_t>(std::count_if(
        changes.begin(), changes.end(), [&](auto* change) { return change->verdict == verdict; }));
  }
};

/// Summarizes either the changes that count or all others.
std::vector<CompareSummary> compare_summaries(const ReportComparison& found, bool counting) {
  std::vector<CompareSummary> all;
  for (const Change& change : found.changes) {
    if (change.counts != counting) continue;
    auto at = std::find_if(all.begin(), all.end(), [&](const CompareSummary& one) {
      return one.table == change.table && one.value == change.value;
    });
    if (at == all.end()) at = all.insert(at, {change.table, change.value, {}});
    at->changes.push_back(&change);
  }
  return all;
}

std::string ratio_text(double ratio) {
  if (std::isinf(ratio)) return "was 0";
  return ratio == 0.0 ? "is 0" : short_number(ratio);
}

std::string figure_text(double value) {
  return value != 0.0 && std::abs(value) < 0.001 ? shown(value, "tiny") : short_number(value);
}

void print_summaries(const std::vector<CompareSummary>& all, const std::string& title) {
  if (all.empty()) return;
  Table table({title, "rows", "mean", "best", "worst", "better", "worse", "noise", "worst row"});
  table.flush_left(8);
  for (const CompareSummary& one : all) {
    const auto [best, worst] = one.extremes();
    table.add({one.table + " " + one.value, grouped(one.changes.size()),
               ratio_text(one.geometric_mean()), ratio_text((*best)->ratio),
               ratio_text((*worst)->ratio), grouped(one.with(ChangeVerdict::better)),
               grouped(one.with(ChangeVerdict::worse)), grouped(one.with(ChangeVerdict::noise)),
               (*worst)->row.substr(one.table.size() + 1)});
  }
  std::cout << table << '\n';
}

const char* word_of(const Change& change) {
  switch (change.verdict) {
    case ChangeVerdict::worse:
      return change.counts ? "WORSE" : "worse (not counted)";
    case ChangeVerdict::better:
      return "better";
    case ChangeVerdict::noise:
      return "noise";
    case ChangeVerdict::same:
      break;
  }
  return "";
}

/// If `all`, returns all changes in their order; otherwise only the changes that count and are
/// worse or better, from the worst to the best.
std::vector<const Change*> chosen_changes(const ReportComparison& found, bool all) {
  std::vector<const Change*> chosen;
  for (const Change& change : found.changes) {
    const bool beyond =
        change.verdict == ChangeVerdict::worse || change.verdict == ChangeVerdict::better;
    if (all || (beyond && change.counts)) chosen.push_back(&change);
  }
  if (!all) {
    std::stable_sort(chosen.begin(), chosen.end(),
                     [](auto* a, auto* b) { return a->ratio > b->ratio; });
  }
  return chosen;
}

void print_changes(const ReportComparison& found, bool all) {
  const auto chosen = chosen_changes(found, all);
  if (chosen.empty()) return;
  Table table({"row", "value", "was", "is", "unit", "ratio", ""});
  for (const std::size_t column : {1U, 4U, 6U}) table.flush_left(column);
  for (const Change* change : chosen) {
    table.add({change->row, change->value, figure_text(change->before), figure_text(change->after),
               change->unit, ratio_text(change->ratio), word_of(*change)});
  }
  std::cout << table << '\n';
}

void print_rest(const ReportComparison& found) {
  if (!found.other_pairs.empty()) {
    Table table({"the same measurement found other pairs", "value", "was", "is"});
    table.flush_left(1);
    for (const OtherPairs& pairs : found.other_pairs) {
      table.add({pairs.row, pairs.value, pairs.before, pairs.after});
    }
    std::cout << table << '\n';
  }
  if (found.only_before + found.only_after + found.values_gone > 0) {
    std::cout << "not compared: " << grouped(found.only_before) << " rows only in the old report, "
              << grouped(found.only_after) << " only in the new one; " << grouped(found.values_gone)
              << " values gone from rows that both have\n";
  }
  const auto better =
      std::count_if(found.changes.begin(), found.changes.end(), [](const Change& change) {
        return change.counts && change.verdict == ChangeVerdict::better;
      });
  std::cout << found.regressions() << " worse, " << better << " better, "
            << found.other_pairs.size() << " with other pairs\n";
}

Json to_json(const ReportComparison& found, const CompareOptions& options) {
  constexpr const char* kVerdicts[] = {"same", "noise", "better", "worse"};
  Json summaries = Json::array();
  for (const CompareSummary& one : compare_summaries(found, true)) {
    const auto [best, worst] = one.extremes();
    summaries.push_back({{"table", one.table},
                         {"value", one.value},
                         {"rows", one.changes.size()},
                         {"geometric_mean", one.geometric_mean()},
                         {"best", (*best)->ratio},
                         {"best_row", (*best)->row},
                         {"worst", (*worst)->ratio},
                         {"worst_row", (*worst)->row}});
  }
  Json changes = Json::array();
  for (const Change& change : found.changes) {
    changes.push_back({{"row", change.row},
                       {"value", change.value},
                       {"unit", change.unit},
                       {"before", change.before},
                       {"after", change.after},
                       {"ratio", change.ratio},
                       {"verdict", kVerdicts[static_cast<std::size_t>(change.verdict)]},
                       {"counts", change.counts}});
  }
  Json pairs = Json::array();
  for (const OtherPairs& one : found.other_pairs) {
    pairs.push_back(
        {{"row", one.row}, {"value", one.value}, {"before", one.before}, {"after", one.after}});
  }
  return {{"passes", found.passes()},          {"regressions", found.regressions()},
          {"threshold", options.threshold},    {"scale", options.scale},
          {"remarks", found.remarks},          {"only_before", found.only_before},
          {"only_after", found.only_after},    {"values_gone", found.values_gone},
          {"summaries", std::move(summaries)}, {"other_pairs", std::move(pairs)},
          {"changes", std::move(changes)}};
}

/// Returns the factor by which times are scaled, and appends a remark that explains the factor or
/// suggests `--scale on`.
double Compare::scale_of(const Results& before, const Results& after,
                         std::vector<std::string>& remarks) const {
  const double ratio = machine_ratio(before, after);
  const bool other = other_machine(before, after);
  const std::string text = "the reference sweep takes " + short_number(ratio) +
                           " times as long as when the old report was made";
  if (scale == "on" || (scale == "auto" && other)) {
    remarks.push_back((other ? "the machines differ: " : "") + text +
                      ", and times are scaled by it");
    return ratio;
  }
  if (other) {
    remarks.emplace_back("the machines differ, and times are not scaled");
  } else if (std::abs(std::log(ratio)) > std::log(1.05)) {
    remarks.push_back(text + ": the machine was busy or slower (--scale on corrects for it)");
  }
  return 1.0;
}

void Compare::add_options(CLI::App& app) {
  app.add_option("old", old_path, "results.json of the older report")->required();
  app.add_option("new", new_path, "results.json of the newer report")->required();
  number(app, "--threshold", threshold, 1.0, 1e9,
         "Smallest factor that counts as worse, if the samples confirm it");
  app.add_flag("--all", all, "List every value, not only values beyond the threshold");
  one_of(app, "--scale", scale, {"auto", "on", "off"},
         "Scale times by the reference sweeps of the machines; auto: if processor or cores differ");
  add_json_option(app, json);
}

int Compare::run() const {
  const Results old_report = read_results(old_path);
  const Results new_report = read_results(new_path);
  std::vector<std::string> remarks;
  const CompareOptions options{threshold, scale_of(old_report, new_report, remarks)};
  ReportComparison found = compare(old_report, new_report, options);
  found.remarks.insert(found.remarks.begin(), remarks.begin(), remarks.end());

  std::cout << "ratios are new / old, for rates old / new: above 1 is worse\n";
  for (const std::string& remark : found.remarks) std::cout << remark << '\n';
  std::cout << '\n';
  print_summaries(compare_summaries(found, true), "table and value");
  print_summaries(compare_summaries(found, false), "other libraries, ratios; not counted");
  print_changes(found, all);
  print_rest(found);
  write_json(json, to_json(found, options));
  return found.passes() ? kDone : kFailed;
}

}  // namespace

void add_compare(CLI::App& app) {
  command<Compare>(app, "compare",
                   "Compares two reports (results.json): the ratio of each value of each row",
                   "Exit status 1 if a value got worse or different pairs were found, 2 if a file "
                   "is not a report.");
}

}  // namespace winnow::bench
