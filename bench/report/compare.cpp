// Compares two reports value by value; `compare` in compare.h states the rule. commands/compare.cpp
// prints the result.

#include "bench/report/compare.h"

#include "bench/common/table.h"
#include "bench/rows/machine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace winnow::bench {
namespace {

enum class CompareUnit { figure, time, rate };

/// Classifies a unit: "ms" and "ns/pair" are times, "1/s" and "GB/s" are rates, others are figures.
CompareUnit unit_kind(const std::string& unit) {
  const std::size_t slash = unit.find('/');
  const std::string over = unit.substr(0, slash);
  if (over == "s" || over == "ms" || over == "us" || over == "ns") return CompareUnit::time;
  return slash != std::string::npos && unit.substr(slash + 1) == "s" ? CompareUnit::rate
                                                                     : CompareUnit::figure;
}

/// A value as a cost: less is better. Values for which more is better are inverted.
struct Cost {
  double best = 0.0;
  double median = 0.0;
  bool steady = true;  ///< enough samples to distinguish a change from noise
};

constexpr std::size_t kFewestSamples = 5;

Cost cost_of(const Json& row, const Json& column) {
  const std::string name = column["name"];
  const bool less = column["better"] == "less";
  Cost cost;
  cost.best = cost.median = value_of(row, name);
  const Json& value = row[name];
  if (value.is_object()) cost.best = value[less ? "min" : "max"];
  if (unit_kind(column["unit"]) != CompareUnit::figure) {
    cost.steady = value.is_object() && value["samples"].get<std::size_t>() >= kFewestSamples;
  }
  return less ? cost : Cost{1.0 / cost.best, 1.0 / cost.median, cost.steady};
}

bool beyond(const Cost& good, const Cost& bad, double threshold) {
  return good.steady && bad.steady && bad.median > threshold * good.median &&
         bad.best > threshold * good.best && bad.best > good.median;
}

ChangeVerdict verdict_of(const Cost& before, const Cost& after, double threshold) {
  if (beyond(before, after, threshold)) return ChangeVerdict::worse;
  if (beyond(after, before, threshold)) return ChangeVerdict::better;
  const double ratio = after.median / before.median;
  return ratio > threshold || ratio < 1.0 / threshold ? ChangeVerdict::noise : ChangeVerdict::same;
}

/// Returns whether the value is a hash of the pairs found.
bool is_fingerprint(const Json& column) {
  return column["name"].get<std::string>().find("fingerprint") != std::string::npos;
}

/// Returns whether the value was computed from values of other rows.
bool is_derived(const Json& row, const std::string& name) {
  if (!row.contains("from")) return false;
  const Json& from = row["from"];
  const auto derives = [&](const Json& one) {
    return one.is_object() && one.value("value", Json()) == name;
  };
  return from.is_array() ? std::any_of(from.begin(), from.end(), derives) : derives(from);
}

bool counts(const Json& table, const Json& row, const std::string& name) {
  if (is_derived(row, name)) return false;
  return std::none_of(table["keys"].begin(), table["keys"].end(), [&](const Json& key) {
    const Json& text = row[key.get<std::string>()];
    return text.is_string() && is_peer(text.get<std::string>());
  });
}

class Comparing {
 public:
  Comparing(const Results& before, const Results& after, const CompareOptions& options)
      : before_(before), after_(after), options_(options) {}

  ReportComparison all() {
    remark_settings();
    for (const Json& table : before_.document()["tables"]) {
      for (const Json& row : table["rows"]) old_rows_[row["id"]] = &row;
    }
    for (const Json& table : after_.document()["tables"]) {
      for (const Json& row : table["rows"]) add_row(table, row);
    }
    found_.only_before = old_rows_.size() - matched_;
    return std::move(found_);
  }

 private:
  const Results& before_;
  const Results& after_;
  CompareOptions options_;
  bool same_questions_ = true;
  bool quick_ = false;  // a report made with --quick has no comparable times
  std::map<std::string, const Json*> old_rows_;
  std::size_t matched_ = 0;
  ReportComparison found_;

  void remark_settings() {
    const Json& was = before_.document()["settings"];
    const Json& is = after_.document()["settings"];
    for (const auto& [name, value] : is.items()) {
      if (was.contains(name) && was[name] == value) continue;
      found_.remarks.push_back("settings differ: " + name + " was " +
                               (was.contains(name) ? was[name].dump() : "not given") + ", is " +
                               value.dump());
      if (name == "seed" || name == "quick") same_questions_ = false;
    }
    for (const auto* report : {&before_, &after_}) {
      const std::string which = report == &before_ ? "the old report" : "the new report";
      const Json& document = report->document();
      if (!document.value("complete", false)) found_.remarks.push_back(which + " is not complete");
      if (document["settings"].value("quick", Json(false)) == true) {
        quick_ = true;
        found_.remarks.push_back(which + " was made with --quick: no time of it counts");
      }
      for (const Json& problem : document.value("problems", Json::array())) {
        found_.remarks.push_back(which + ", problem: " + problem.get<std::string>());
      }
    }
  }

  void add_row(const Json& table, const Json& row) {
    const auto at = old_rows_.find(row["id"]);
    if (at == old_rows_.end()) {
      ++found_.only_after;
      return;
    }
    ++matched_;
    const Json& old = *at->second;
    for (const Json& column : table["values"]) {
      const std::string name = column["name"];
      if (!old.contains(name)) continue;
      if (!row.contains(name)) {
        ++found_.values_gone;
      } else if (is_fingerprint(column)) {
        add_fingerprint(row, old, name);
      } else if (column["better"] != "neither") {
        add_value(table, row, old, column);
      }
    }
  }

  void add_fingerprint(const Json& row, const Json& old, const std::string& name) {
    const bool same_command = row.value("command", "") == old.value("command", "");
    if (!same_questions_ || !same_command || row[name] == old[name]) return;
    found_.other_pairs.push_back({row["id"], name, old[name], row[name]});
  }

  void add_value(const Json& table, const Json& row, const Json& old, const Json& column) {
    const std::string name = column["name"];
    Change change{.table = table["name"],
                  .row = row["id"],
                  .value = name,
                  .unit = column["unit"],
                  .before = value_of(old, name),
                  .after = value_of(row, name),
                  .counts = counts(table, row, name)};
    if (!(change.before >= 0.0) || !(change.after >= 0.0)) return;
    if (change.before == 0.0 || change.after == 0.0) {
      add_zero(std::move(change), column);
      return;
    }
    const Cost was = cost_of(old, column);
    Cost is = cost_of(row, column);
    if (const CompareUnit kind = unit_kind(change.unit); kind != CompareUnit::figure) {
      is = {is.best / options_.scale, is.median / options_.scale, is.steady && !quick_};
      change.after =
          kind == CompareUnit::time ? change.after / options_.scale : change.after * options_.scale;
    }
    change.ratio = is.median / was.median;
    change.verdict = verdict_of(was, is, options_.threshold);
    found_.changes.push_back(std::move(change));
  }

  /// Handles a value that is zero in a report. A time of zero was too short to be measured, so it
  /// gives no verdict.
  void add_zero(Change change, const Json& column) {
    if (change.before != change.after) {
      if (unit_kind(change.unit) != CompareUnit::figure) return;
      const bool worse = (change.after > change.before) == (column["better"] == "less");
      change.verdict = worse ? ChangeVerdict::worse : ChangeVerdict::better;
      change.ratio = worse ? std::numeric_limits<double>::infinity() : 0.0;
    }
    found_.changes.push_back(std::move(change));
  }
};

double sweep_ms(const Results& results) {
  const Json& machine = results.document()["machine"];
  const auto at = machine.find("reference_sweep_ms");
  return at != machine.end() && at->is_number() ? at->get<double>() : 0.0;
}

}  // namespace

std::size_t ReportComparison::regressions() const {
  return static_cast<std::size_t>(
      std::count_if(changes.begin(), changes.end(), [](const Change& change) {
        return change.counts && change.verdict == ChangeVerdict::worse;
      }));
}

ReportComparison compare(const Results& before, const Results& after,
                         const CompareOptions& options) {
  return Comparing(before, after, options).all();
}

double machine_ratio(const Results& before, const Results& after) {
  const double was = sweep_ms(before);
  const double is = sweep_ms(after);
  return was > 0.0 && is > 0.0 ? is / was : 1.0;
}

bool other_machine(const Results& before, const Results& after) {
  const Json& was = before.document()["machine"];
  const Json& is = after.document()["machine"];
  return was.value("processor", Json()) != is.value("processor", Json()) ||
         was.value("cores", Json()) != is.value("cores", Json());
}

}  // namespace winnow::bench
