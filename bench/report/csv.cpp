#include "bench/report/csv.h"

#include "bench/pages/html.h"

#include <algorithm>
#include <vector>

namespace winnow::bench {
namespace {

std::string field(const Json& object, const std::string& name) {
  const auto at = object.find(name);
  if (at == object.end()) return "";
  const std::string text = at->is_string() ? at->get<std::string>() : at->dump();
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  return '"' + replaced(text, "\"", "\"\"") + '"';
}

}  // namespace

std::string to_csv(const Json& table) {
  std::vector<std::string> lines(table["rows"].size() + 1);
  const auto add_column = [&](const std::string& name, const char* part) {
    lines[0] += name + (part == nullptr ? "" : std::string("_") + part) + ",";
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const Json& row = table["rows"][i - 1];
      const bool is_spread = row.contains(name) && row[name].is_object();
      if (part != nullptr && is_spread) lines[i] += field(row[name], part);
      if (part == nullptr) lines[i] += field(row, name);
      lines[i] += ",";
    }
  };
  std::vector<std::string> names = table["keys"];
  for (const Json& value : table["values"]) names.push_back(value["name"]);
  for (const std::string& name : names) {
    const bool is_spread =
        std::any_of(table["rows"].begin(), table["rows"].end(),
                    [&](const Json& row) { return row.contains(name) && row[name].is_object(); });
    if (!is_spread) add_column(name, nullptr);
    for (const char* part : {"min", "median", "max"}) {
      if (is_spread) add_column(name, part);
    }
  }
  std::string text;
  for (const std::string& line : lines) text += line.substr(0, line.size() - 1) + "\n";
  return text;
}

}  // namespace winnow::bench
