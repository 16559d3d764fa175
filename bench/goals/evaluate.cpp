// Evaluates goals: picks figures from the rows that measurements made, combines them, and compares
// the result with the bound. commands/goals.cpp calls `evaluate` for each entry;
// goals/measurement_cache.cpp runs the measurements.

#include "bench/goals/evaluate.h"

#include <winnow/simd/isa.h>
#include "bench/common/table.h"
#include "bench/goals/goal_entries.h"
#include "bench/rows/machine.h"
#include "bench/rows/template_text.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

namespace winnow::bench {
namespace {

/// Stored as the measured value if there is no answer, or a wrong one, and less is better.
constexpr double kUnanswered = 1e6;
/// Milliseconds of the reference sweep on the machine on which the other libraries were timed.
constexpr double kReferenceMachineMs = 23.0;

struct GoalFigure {
  double value = 0.0;
  std::string from;  ///< the rows from which it was computed
};

bool is_of_peer(const Json& row, const Json& keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const Json& key) {
    const Json& text = row[key.get<std::string>()];
    return text.is_string() && is_peer(text.get<std::string>());
  });
}

bool is_any_of(const Json& value, const Json& allowed) {
  if (allowed == "@isa") return value == isa_name();
  if (!allowed.is_array()) return value == allowed;
  return std::find(allowed.begin(), allowed.end(), value) != allowed.end();
}

bool is_meant(const Json& table, const Json& row, const Json& where) {
  return std::all_of(where.items().begin(), where.items().end(), [&](const auto& member) {
    if (member.key() == "peer") return is_of_peer(row, table["keys"]) == member.value();
    return row.contains(member.key()) && is_any_of(row[member.key()], member.value());
  });
}

/// Returns the id without the table's name, which is clear from the goal.
std::string short_id(const Json& row) {
  const std::string id = row["id"];
  return id.substr(id.find('/') + 1);
}

/// The rows of one entry, narrowed to some values of keys.
class Rows {
 public:
  explicit Rows(std::vector<const Measured*> from) : from_(std::move(from)) {}

  /// Returns the rows of a figure. Members of `narrowed` that are not keys of the table are
  /// ignored.
  [[nodiscard]] std::vector<const Json*> of(const Json& figure, const Json& narrowed) const {
    const std::string name = figure.at("of");
    std::vector<const Json*> rows;
    for (const Measured* one : from_) {
      const Json* table = one->results.table(name);
      if (table == nullptr) continue;
      Json where = figure.value("where", Json::object());
      for (const auto& [key, value] : narrowed.items()) {
        const Json& keys = (*table)["keys"];
        const bool has = std::find(keys.begin(), keys.end(), key) != keys.end();
        if (has && !where.contains(key)) where[key] = value;
      }
      for (const Json& row : (*table)["rows"]) {
        if (is_meant(*table, row, where)) rows.push_back(&row);
      }
    }
    return rows;
  }
  /// Returns the factor by which this machine was slower than the reference machine.
  [[nodiscard]] double scale() const {
    for (const Measured* one : from_) {
      if (one->machine_ms > 0.0) return one->machine_ms / kReferenceMachineMs;
    }
    return 1.0;
  }

 private:
  std::vector<const Measured*> from_;
};

GoalFigure sum_of(const std::vector<const Json*>& rows, const std::string& value) {
  GoalFigure sum;
  for (const Json* row : rows) {
    const double one = value_of(*row, value);
    if (one == 0.0) continue;
    sum.value += one;
    sum.from += (sum.from.empty() ? "" : "; ") + short_id(*row) + " " + short_number(one);
  }
  sum.from += (sum.from.empty() ? "of " : "; of ") + std::to_string(rows.size()) + " rows";
  return sum;
}

/// Returns the exponent of growth of `value` with "objects".
GoalFigure exponent_of(const std::vector<const Json*>& rows, const std::string& value) {
  std::vector<GrowthPoint> points;
  for (const Json* row : rows) points.push_back({value_of(*row, "objects"), value_of(*row, value)});
  return {fitted_exponent(points), "of " + std::to_string(rows.size()) + " rows"};
}

/// Applies the figure's rule to its rows; nothing if there are none.
std::optional<GoalFigure> picked(const Json& figure, const Rows& rows, const Json& narrowed) {
  for (const char* rule : {"least", "most", "sum", "exponent", "the"}) {
    if (!figure.contains(rule)) continue;
    const std::string value = figure[rule];
    std::vector<const Json*> found = rows.of(figure, narrowed);
    std::erase_if(found, [&](const Json* row) { return !row->contains(value); });
    if (found.empty()) return std::nullopt;
    if (rule == std::string("sum")) return sum_of(found, value);
    if (rule == std::string("exponent")) return exponent_of(found, value);
    if (rule == std::string("the") && found.size() > 1) {
      throw std::runtime_error("goals.json: more than one row for " + figure.dump());
    }
    const Json* best = *std::min_element(found.begin(), found.end(), [&](auto* a, auto* b) {
      return rule == std::string("most") ? value_of(*a, value) > value_of(*b, value)
                                         : value_of(*a, value) < value_of(*b, value);
    });
    const double number = value_of(*best, value);
    return GoalFigure{number, short_id(*best) + " " + short_number(number)};
  }
  throw std::runtime_error("goals.json: no figure: " + figure.dump());
}

std::optional<GoalFigure> figure_of(const Json& figure, const Rows& rows, const Json& narrowed) {
  if (figure.is_number()) return GoalFigure{figure.get<double>(), ""};
  const auto existing = [&](double ms) {
    return GoalFigure{ms * rows.scale(),
                      "existing " + short_number(ms) + " x " + short_number(rows.scale())};
  };
  std::optional<GoalFigure> found;
  if (figure.contains("existing")) {
    found = existing(figure["existing"]);
  } else if (figure.contains("least_of")) {
    for (const Json& one : figure["least_of"]) {
      const auto other = figure_of(one, rows, narrowed);
      if (other && (!found || other->value < found->value)) found = other;
    }
  } else {
    found = picked(figure, rows, narrowed);
    if (!found && figure.contains("else_existing")) found = existing(figure["else_existing"]);
  }
  if (found && figure.contains("divided_by")) {
    const double by = figure["divided_by"];
    found->value /= by;
    found->from += " / " + short_number(by);
  }
  return found;
}

/// Returns the combinations of these keys among the rows of the value.
std::vector<Json> combinations_of(const Json& keys, const Json& value, const Rows& rows,
                                  const Json& narrowed) {
  std::vector<Json> all;
  for (const Json* row : rows.of(value, narrowed)) {
    Json one = narrowed;
    for (const std::string key : keys) one[key] = row->at(key);
    if (std::find(all.begin(), all.end(), one) == all.end()) all.push_back(std::move(one));
  }
  return all;
}

/// Returns the measured value for these keys; nothing if a figure has no row.
std::optional<GoalFigure> measured_of(const Json& entry, const Rows& rows, const Json& narrowed) {
  auto value = figure_of(entry["value"], rows, narrowed);
  if (!value || !entry.contains("over")) return value;
  const auto over = figure_of(entry["over"], rows, narrowed);
  if (!over) return std::nullopt;
  value->value /= over->value;
  if (!over->from.empty()) value->from += " over " + over->from;
  return value;
}

/// Returns the measured value of each combination of these keys that has one.
std::vector<GoalFigure> measured_by(const Json& keys, const Json& entry, const Rows& rows,
                                    const Json& narrowed) {
  std::vector<GoalFigure> figures;
  for (const Json& one : combinations_of(keys, entry["value"], rows, narrowed)) {
    if (auto figure = measured_of(entry, rows, one)) figures.push_back(std::move(*figure));
  }
  return figures;
}

std::optional<GoalFigure> aggregate(const Json& entry, const Rows& rows, const Json& narrowed,
                                    bool at_least) {
  const bool worst = entry.contains("worst_by");
  if (!worst && !entry.contains("median_by")) return measured_of(entry, rows, narrowed);
  auto figures = measured_by(entry[worst ? "worst_by" : "median_by"], entry, rows, narrowed);
  if (figures.empty()) return std::nullopt;
  const auto better = [&](const GoalFigure& a, const GoalFigure& b) {
    return at_least ? a.value > b.value : a.value < b.value;
  };
  if (worst) return *std::max_element(figures.begin(), figures.end(), better);
  std::vector<double> values;
  for (const GoalFigure& figure : figures) values.push_back(figure.value);
  const GoalFigure& last = *std::max_element(figures.begin(), figures.end(), better);
  return GoalFigure{median_of(values), "of " + std::to_string(values.size()) + ", the worst " +
                                           short_number(last.value) + " of " + last.from};
}

/// Returns nothing if the entry is optional and has no value or bound.
std::optional<Goal> goal_of(const Json& entry, const Rows& rows, const Json& narrowed) {
  Goal goal{.topic = entry["topic"],
            .what = filled(entry["what"], narrowed),
            .unit = entry["unit"],
            .at_least = entry.contains("at_least")};
  const auto bound = figure_of(entry[goal.at_least ? "at_least" : "at_most"], rows, narrowed);
  const auto value = aggregate(entry, rows, narrowed, goal.at_least);
  if ((!bound || !value) && entry.value("optional", false)) return std::nullopt;
  goal.bound = bound ? bound->value : 0.0;
  goal.measured = value ? value->value : goal.at_least ? 0.0 : kUnanswered;
  goal.detail = value ? value->from : "no such row";
  if (bound && !bound->from.empty()) goal.detail += "; bound " + bound->from;
  return goal;
}

}  // namespace

std::vector<Goal> evaluate(const Json& entry, MeasurementCache& measurement_cache) {
  const Json& measure = entry["measure"];
  const Json requests = measure.is_array() ? measure : Json::array({measure});
  std::vector<const Measured*> from;
  std::string fault;
  for (const Json& request : requests) {
    const Measured& one = measurement_cache.measured(request);
    if (one.absent) return {};
    if (fault.empty()) fault = one.fault;
    from.push_back(&one);
  }
  if (!fault.empty()) {
    const bool at_least = entry.contains("at_least");
    std::string what = entry["what"];
    std::erase_if(what, [](char c) { return c == '{' || c == '}'; });
    return {{.topic = entry["topic"],
             .what = std::move(what),
             .unit = entry["unit"],
             .at_least = at_least,
             .measured = at_least ? -kUnanswered : kUnanswered,
             .detail = fault}};
  }
  const Rows rows(std::move(from));
  std::vector<Json> groups{Json::object()};
  if (entry.contains("by"))
    groups = combinations_of(entry["by"], entry["value"], rows, Json::object());
  std::vector<Goal> goals;
  for (const Json& narrowed : groups) {
    if (auto goal = goal_of(entry, rows, narrowed)) goals.push_back(std::move(*goal));
  }
  return goals;
}

}  // namespace winnow::bench
