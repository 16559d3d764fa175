#include "bench/report/csv.h"

#include "bench/pages/html.h"
#include "bench/rows/results.h"

#include <algorithm>

namespace winnow::bench {
namespace {

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  return '"' + replaced(text, "\"", "\"\"") + '"';
}

std::string csv_field(const Json& row, const std::string& name) {
  const auto at = row.find(name);
  if (at == row.end()) return "";
  return quoted(at->is_string() ? at->get<std::string>() : at->dump());
}

constexpr const char* kSpread[] = {"min", "median", "max"};

}  // namespace

std::string to_csv(const Json& table) {
  const Json& rows = table["rows"];
  std::string head;
  std::vector<std::pair<std::string, bool>> columns;
  const auto add_column = [&](const std::string& name) {
    const bool spread = std::any_of(rows.begin(), rows.end(), [&](const Json& row) {
      return row.contains(name) && row[name].is_object();
    });
    columns.emplace_back(name, spread);
    if (!spread) head += (head.empty() ? "" : ",") + name;
    for (const char* part : kSpread) {
      if (spread) head += (head.empty() ? "" : ",") + name + "_" + part;
    }
  };
  for (const Json& key : table["keys"]) add_column(key);
  for (const Json& value : table["values"]) add_column(value["name"]);
  std::string text = head + "\n";
  for (const Json& row : rows) {
    std::string line;
    for (const auto& [name, spread] : columns) {
      if (!spread) line += csv_field(row, name) + ",";
      for (const char* part : kSpread) {
        if (!spread) continue;
        const bool has = row.contains(name) && row[name].is_object();
        line += (has ? csv_field(row[name], part) : "") + std::string(",");
      }
    }
    line.back() = '\n';
    text += line;
  }
  return text;
}

}  // namespace winnow::bench
