// The document of a report: tables, rows and their ids, and the formatting of values. Commands and
// bench/rows add rows; bench/report reads them. document_check.cpp validates documents from files.

#include "bench/rows/results.h"

#include <winnow/simd/isa.h>
#include "bench/common/errors.h"
#include "bench/common/table.h"
#include "bench/rows/document_check.h"
#include "bench/rows/machine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

namespace winnow::bench {
namespace {

constexpr std::array<const char*, 5> kFormats{"number", "tiny", "count", "percent", "text"};
constexpr std::array<const char*, 3> kBetter{"neither", "less", "more"};

bool matches(const Json& row, const Json& where) {
  return std::all_of(where.items().begin(), where.items().end(), [&](const auto& member) {
    return row.contains(member.key()) && row[member.key()] == member.value();
  });
}

bool is_known(const Json& table, const std::string& member) {
  if (member == "command" || member == "from") return true;
  const Json& keys = table["keys"];
  const Json& values = table["values"];
  return std::find(keys.begin(), keys.end(), member) != keys.end() ||
         std::any_of(values.begin(), values.end(),
                     [&](const Json& value) { return value["name"] == member; });
}

}  // namespace

Results::Results()
    : document_({{"format", kReportFormat},
                 {"complete", false},
                 {"machine", {{"isa", isa_name()}, {"isas", isa_names()}}},
                 {"settings", Json::object()},
                 {"missing", Json::array()},
                 {"warnings", Json::array()},
                 {"problems", Json::array()},
                 {"sections", Json::array()},
                 {"tables", Json::array()}}) {}

Results::Results(Json document) : document_(std::move(document)) {
  if (const std::string fault = fault_of_report(document_); !fault.empty()) {
    throw ArgumentError(std::string("this is no \"") + kReportFormat + "\": " + fault);
  }
}

Json* Results::find_table(const std::string& name) {
  for (Json& table : document_["tables"]) {
    if (table["name"] == name) return &table;
  }
  return nullptr;
}

const Json* Results::table(const std::string& name) const {
  return const_cast<Results*>(this)->find_table(name);
}

void Results::declare(const TableSpec& spec) {
  if (find_table(spec.name) != nullptr) return;
  Json values = Json::array();
  for (const ValueColumn& value : spec.values) {
    values.push_back({{"name", value.name},
                      {"label", value.label},
                      {"unit", value.unit},
                      {"better", kBetter[static_cast<std::size_t>(value.better)]},
                      {"format", kFormats[static_cast<std::size_t>(value.format)]}});
  }
  document_["tables"].push_back({{"name", spec.name},
                                 {"section", spec.section},
                                 {"title", spec.title},
                                 {"keys", spec.keys},
                                 {"values", std::move(values)},
                                 {"rows", Json::array()}});
}

std::string Results::add(const std::string& name, Json row) {
  Json* table = find_table(name);
  if (table == nullptr) throw std::logic_error("no table " + name);
  Json whole{{"id", row_id(*table, row)}};
  for (const auto& [member, value] : row.items()) {
    if (!is_known(*table, member)) throw std::logic_error(name + " has no " + member);
    const bool unknown =
        value.is_null() || (value.is_number_float() && !std::isfinite(value.get<double>()));
    if (!unknown) whole[member] = value;
  }
  const std::string id = whole["id"];
  Json& rows = (*table)["rows"];
  const auto at =
      std::find_if(rows.begin(), rows.end(), [&](const Json& other) { return other["id"] == id; });
  if (at != rows.end()) {
    *at = std::move(whole);
  } else {
    rows.push_back(std::move(whole));
  }
  return id;
}

std::vector<const Json*> Results::rows(const std::string& name, const Json& where) const {
  std::vector<const Json*> found;
  const Json* of = table(name);
  if (of == nullptr) return found;
  for (const Json& row : (*of)["rows"]) {
    if (matches(row, where)) found.push_back(&row);
  }
  return found;
}

const Json* Results::row(const std::string& name, const Json& where) const {
  const auto found = rows(name, where);
  return found.empty() ? nullptr : found.front();
}

const Json* Results::column(const std::string& name, const std::string& value) const {
  const Json* of = table(name);
  if (of == nullptr) return nullptr;
  for (const Json& column : (*of)["values"]) {
    if (column["name"] == value) return &column;
  }
  return nullptr;
}

Results read_results(const std::string& path) {
  Json document = read_json(path);
  try {
    return Results(std::move(document));
  } catch (const ArgumentError& error) {
    throw ArgumentError(path + ": " + error.what());
  }
}

Json to_value(const std::vector<double>& samples) {
  if (samples.empty()) return nullptr;
  const Spread spread = spread_of(samples);
  return {{"min", spread.min},
          {"median", spread.median},
          {"max", spread.max},
          {"samples", samples.size()}};
}

std::string heading_of(const Json& column) {
  const std::string unit = column["unit"];
  const std::string label = column["label"];
  return unit.empty() ? label : label + ", " + unit;
}

double value_of(const Json& row, const std::string& name) {
  const auto at = row.find(name);
  if (at == row.end()) return std::numeric_limits<double>::quiet_NaN();
  if (at->is_number()) return at->get<double>();
  if (at->is_object()) return at->value("median", std::numeric_limits<double>::quiet_NaN());
  return std::numeric_limits<double>::quiet_NaN();
}

Json derived(const std::string& name, const std::string& rule, const std::string& field,
             const std::vector<std::string>& rows) {
  return {{"value", name}, {"rule", rule}, {"field", field}, {"rows", rows}};
}

std::string shown(double value, const std::string& format) {
  if (!std::isfinite(value)) return "-";
  if (format == "percent") return percent(value);
  if (format == "count") {
    const std::string digits = grouped(static_cast<std::size_t>(std::llround(std::abs(value))));
    return value < 0.0 ? "-" + digits : digits;
  }
  if (format == "tiny" && value != 0.0) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1e", value);
    return text;
  }
  return short_number(value);
}

std::string shown(const Json& row, const Json& column) {
  const std::string name = column["name"];
  const auto at = row.find(name);
  if (at != row.end() && at->is_string()) return at->get<std::string>();
  return shown(value_of(row, name), column["format"].get<std::string>());
}

std::string spread_text(const Json& row, const std::string& name, const std::string& format) {
  const auto at = row.find(name);
  if (at == row.end() || !at->is_object()) return "";
  return " (" + shown((*at)["min"].get<double>(), format) + " to " +
         shown((*at)["max"].get<double>(), format) + ")";
}

std::vector<Json> distinct(const std::vector<const Json*>& rows, const std::string& key) {
  std::vector<Json> found;
  for (const Json* row : rows) {
    if (!row->contains(key)) continue;
    const Json& value = (*row)[key];
    if (std::find(found.begin(), found.end(), value) == found.end()) found.push_back(value);
  }
  return found;
}

std::string row_id(const Json& table, const Json& row) {
  std::string id = table["name"];
  for (const Json& key : table["keys"]) {
    const std::string name = key;
    if (!row.contains(name)) throw std::logic_error(id + ": a row without " + name);
    id += '/' + key_text(row[name]);
  }
  return id;
}

std::string key_text(const Json& key) {
  if (key.is_string()) return key.get<std::string>();
  if (key.is_number_float()) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", key.get<double>());
    return text;
  }
  return key.dump();
}

}  // namespace winnow::bench
