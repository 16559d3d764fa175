#include "report/sections/accuracy_rows.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace winnow::bench {
namespace {

void add_shown(Json& row, const std::string& of) {
  const auto at = row.find("worst_" + of);
  if (at == row.end()) return;
  row["worst_" + of + "_or_floor"] = std::max(at->get<double>(), kLeastErrorShown);
}

void add_columns(std::vector<ValueColumn>& columns, const std::string& of, const std::string& label,
                 const std::string& unit) {
  for (const char* which : {"median", "p99", "worst"}) {
    const std::string rank = which == std::string("p99") ? "99 %" : which;
    columns.push_back({which + ("_" + of), rank + " " + label, unit, Better::less, Format::tiny});
  }
  columns.push_back({"worst_" + of + "_or_floor", "worst " + label + ", at least 1e-17", unit,
                     Better::less, Format::tiny});
}

}  // namespace

std::string with_peers(const std::string& command) {
  const std::string run = "bench/run ";
  return run + "--with-peers " + command.substr(run.size());
}

std::vector<ValueColumn> accuracy_columns() {
  std::vector<ValueColumn> columns{
      {"pairs", "pairs judged", "", Better::neither, Format::count},
      {"wrong", "wrong verdicts", "", Better::less, Format::count},
      {"missing", "without distance or normal", "", Better::less, Format::count}};
  add_columns(columns, "error", "error of the signed distance", "of the size");
  add_columns(columns, "distance", "error of the distance", "of the size");
  add_columns(columns, "depth", "error of the depth", "of the size");
  add_columns(columns, "degrees", "error of the normal", "degrees");
  const std::vector<ValueColumn> counts{
      {"measured", "distances measured", "", Better::neither, Format::count},
      {"beyond_bound", "beyond the bound given", "", Better::less, Format::count},
      {"normals", "normals that are unique", "", Better::neither, Format::count},
      {"normals_off", "of them off by 0.01 degrees", "", Better::less, Format::count},
      {"recomputed", "recomputed", "", Better::neither, Format::percent},
      {"judge", "judge", "", Better::neither, Format::text}};
  columns.insert(columns.end(), counts.begin(), counts.end());
  return columns;
}

std::vector<ValueColumn> accuracy_curve_columns() {
  constexpr std::array<std::string_view, 11> kept{"pairs",
                                                  "wrong",
                                                  "missing",
                                                  "median_error",
                                                  "p99_error",
                                                  "worst_error",
                                                  "worst_error_or_floor",
                                                  "worst_distance",
                                                  "worst_depth",
                                                  "worst_degrees",
                                                  "judge"};
  std::vector<ValueColumn> columns = accuracy_columns();
  std::erase_if(columns, [&](const ValueColumn& column) {
    return std::find(kept.begin(), kept.end(), column.name) == kept.end();
  });
  return columns;
}

void add_accuracy_row(Results& results, const std::string& table, Json row,
                      const Accuracy& accuracy, const AccuracyOptions& options) {
  Json figures = to_json(accuracy);
  for (const char* of : {"error", "distance", "depth", "degrees"}) add_shown(figures, of);
  figures["judge"] = judge_name(options.judge);
  for (const auto& [name, value] : figures.items()) {
    if (results.column(table, name) != nullptr) row[name] = value;
  }
  if (!row.contains("command")) row["command"] = accuracy_command(options);
  const bool is_tier =
      std::find(kTierNames.begin(), kTierNames.end(), accuracy.engine) != kTierNames.end();
  if (!is_tier) row["command"] = with_peers(row["command"]);
  results.add(table, std::move(row));
}

void show_command(ReportPage& page, const std::string& table, const Json& where) {
  const Json* row = page.results().row(table, where);
  if (row != nullptr && row->contains("command")) page.command((*row)["command"]);
}

std::string power_text(double value) {
  return key_text(Json(value));
}

}  // namespace winnow::bench
