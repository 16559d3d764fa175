#include "bench/rows/results.h"

#include "bench/common/table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>

namespace winnow::bench {
namespace {

std::string number_text(double value) {
  if (value == 0.0 || std::abs(value) >= 1e-3) return short_number(value);
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", value);
  return text;
}

std::string shown(const Json& value) {
  if (value.is_object()) {
    return shown(value["median"]) + " (" + shown(value["min"]) + " to " + shown(value["max"]) + ")";
  }
  if (value.is_number_integer() && value >= 0) return grouped(value.get<std::size_t>());
  return value.is_number() ? number_text(value.get<double>()) : key_text(value);
}

/// Returns "update ms" for "update_ms".
std::string heading(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

std::vector<std::string> members_of(const std::vector<const Json*>& rows) {
  std::vector<std::string> names;
  for (const Json* row : rows) {
    for (const auto& [name, value] : row->items()) {
      if (!has(names, name) && name != "name" && name != "command") names.push_back(name);
    }
  }
  return names;
}

}  // namespace

void print_rows(std::ostream& out, const Results& results, const std::string& family,
                const std::vector<std::string>& values) {
  const auto rows = results.rows(family);
  if (rows.empty()) return;
  const auto keys = keys_of(family);
  const auto members = members_of(rows);
  std::string title = heading(family);
  std::vector<std::string> columns;
  for (const std::string& key : keys) {
    if (rows.size() > 1 && distinct(rows, key).size() == 1) {
      title += ", " + key + " " + shown((*rows.front())[key]);
    } else if (has(members, key)) {
      columns.push_back(key);
    }
  }
  for (const std::string& value : values.empty() ? members : values) {
    if (has(members, value) && !has(keys, value)) columns.push_back(value);
  }
  std::vector<std::string> header;
  for (const std::string& column : columns) header.push_back(heading(column));
  Table text(header);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Json& first = *rows.front();
    if (first.contains(columns[c]) && first[columns[c]].is_string()) text.flush_left(c);
  }
  for (const Json* row : rows) {
    std::vector<std::string> cells;
    for (const std::string& column : columns) {
      cells.push_back(row->contains(column) ? shown((*row)[column]) : "-");
    }
    text.add(std::move(cells));
  }
  out << '\n' << title << '\n' << text << std::flush;
}

}  // namespace winnow::bench
