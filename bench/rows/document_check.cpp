#include "bench/rows/document_check.h"

#include <algorithm>
#include <cstdint>
#include <initializer_list>

namespace winnow::bench {
namespace {

/// Thrown if a document is not a report.
struct ReportFault {
  std::string what;
};

void demand(bool holds, const std::string& what) {
  if (!holds) throw ReportFault{what};
}

bool is_text(const Json& json) {
  return json.is_string();
}

const Json& demand_member(const Json& object, const char* name, bool (*fits)(const Json&),
                          const std::string& where) {
  demand(object.is_object(), where + " is no object");
  const auto at = object.find(name);
  demand(at != object.end(), where + " has no \"" + name + "\"");
  demand(fits(*at), where + " has a \"" + name + "\" of another type");
  return *at;
}

void demand_texts(const Json& object, std::initializer_list<const char*> names,
                  const std::string& where) {
  for (const char* name : names) (void)demand_member(object, name, is_text, where);
}

constexpr auto kIsArray = [](const Json& json) { return json.is_array(); };
constexpr auto kIsObject = [](const Json& json) { return json.is_object(); };
constexpr auto kIsNumber = [](const Json& json) { return json.is_number(); };
constexpr auto kIsCount = [](const Json& json) {
  return json.is_number_integer() && json.get<std::int64_t>() >= 0;
};
constexpr auto kIsBool = [](const Json& json) { return json.is_boolean(); };
constexpr auto kIsTexts = [](const Json& json) {
  return json.is_array() && std::all_of(json.begin(), json.end(), is_text);
};

void check_value(const Json& value, const std::string& where) {
  if (value.is_number() || value.is_string() || value.is_boolean()) return;
  for (const char* name : {"min", "median", "max"}) {
    (void)demand_member(value, name, kIsNumber, where);
  }
  (void)demand_member(value, "samples", kIsCount, where);
}

void check_row(const Json& table, const Json& row, const std::string& table_text) {
  const std::string id = demand_member(row, "id", is_text, "a row of " + table_text);
  const std::string where = "row \"" + id + "\"";
  for (const Json& key : table["keys"]) {
    const std::string name = key;
    demand(row.contains(name), where + " has no \"" + name + "\"");
    const Json& value = row[name];
    demand(value.is_string() || value.is_number() || value.is_boolean(),
           where + " has a key \"" + name + "\" of another type");
  }
  for (const Json& column : table["values"]) {
    const std::string name = column["name"];
    if (row.contains(name)) check_value(row[name], where + ", \"" + name + "\"");
  }
  if (row.contains("command")) demand_texts(row, {"command"}, where);
}

void check_table(const Json& table) {
  const std::string name = demand_member(table, "name", is_text, "a table");
  const std::string where = "table \"" + name + "\"";
  // CSV files are named after the table.
  demand(!name.empty() &&
             name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos,
         where + " has a name that is not of small letters");
  demand_texts(table, {"section", "title"}, where);
  (void)demand_member(table, "keys", kIsTexts, where);
  for (const Json& column : demand_member(table, "values", kIsArray, where)) {
    demand_texts(column, {"name", "label", "unit", "better", "format"}, "a column of " + where);
  }
  for (const Json& row : demand_member(table, "rows", kIsArray, where)) {
    check_row(table, row, where);
  }
}

void check_report(const Json& document) {
  const std::string format = demand_member(document, "format", is_text, "it");
  demand(format == kReportFormat, "its format is \"" + format + "\"");
  (void)demand_member(document, "complete", kIsBool, "it");
  const Json& machine = demand_member(document, "machine", kIsObject, "it");
  demand_texts(machine, {"isa"}, "\"machine\"");
  (void)demand_member(machine, "reference_sweep_ms", kIsNumber, "\"machine\"");
  const Json& settings = demand_member(document, "settings", kIsObject, "it");
  if (settings.contains("quick")) (void)demand_member(settings, "quick", kIsBool, "\"settings\"");
  (void)demand_member(document, "missing", kIsTexts, "it");
  (void)demand_member(document, "problems", kIsTexts, "it");
  if (document.contains("warnings")) (void)demand_member(document, "warnings", kIsTexts, "it");
  for (const Json& section : demand_member(document, "sections", kIsArray, "it")) {
    demand_texts(section, {"id", "title"}, "a section");
    (void)demand_member(section, "steps", kIsCount, "a section");
    (void)demand_member(section, "done", kIsCount, "a section");
    (void)demand_member(section, "seconds", kIsNumber, "a section");
  }
  for (const Json& table : demand_member(document, "tables", kIsArray, "it")) check_table(table);
}

}  // namespace

std::string fault_of_report(const Json& document) {
  try {
    check_report(document);
  } catch (const ReportFault& fault) {
    return fault.what;
  }
  return "";
}

}  // namespace winnow::bench
