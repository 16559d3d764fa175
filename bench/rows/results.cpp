// Rows of results: their names, the form in which they are written, and their tables in a terminal.

#include "bench/rows/results.h"

#include "bench/common/sample.h"
#include "bench/common/table.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <limits>
#include <ostream>
#include <regex>
#include <stdexcept>
#include <utility>

namespace winnow::bench {

extern const char* const kFamilies;  // the text of families.json

namespace {

/// Returns the entry of a family in families.json: "keys", and as "time" the value that becomes
/// `real_time`, if there is one.
const Json& family_named(const std::string& name) {
  static const Json families = Json::parse(kFamilies);
  const auto at = families.find(name);
  if (at == families.end()) throw std::logic_error("no family of rows " + name);
  return *at;
}

bool matches(const Json& row, const Json& where) {
  return std::all_of(where.items().begin(), where.items().end(), [&](const auto& member) {
    return row.contains(member.key()) && row[member.key()] == member.value();
  });
}

std::string name_of(const std::string& family, const Json& row) {
  std::string name = family;
  for (const std::string& key : keys_of(family)) {
    const auto at = row.find(key);
    if (at == row.end()) continue;
    const std::string text = key_text(*at);
    name += "/" + (at->is_string() && key != "isa" ? word_of(text) : key + ":" + text);
  }
  return name;
}

/// Returns a row in the form of Google Benchmark.
Json benchmark_of(const std::string& family, const Json& row) {
  Json shown{{"name", row["name"]}, {"run_name", row["name"]}, {"run_type", "iteration"},
             {"iterations", 1},     {"real_time", 0.0},        {"cpu_time", 0.0},
             {"time_unit", "ms"}};
  const auto keys = keys_of(family);
  const Json& time = member(family_named(family), "time");
  for (const auto& [key, value] : row.items()) {
    if (key == "name" || std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    const bool is_time = key == time;
    const std::string name = is_time ? "real_time" : key;
    shown[name] = value.is_object() ? value["median"] : value;
    if (is_time) shown["cpu_time"] = shown[name];
    if (!value.is_object()) continue;
    shown[name + "_min"] = value["min"];
    shown[name + "_max"] = value["max"];
    if (is_time) shown["iterations"] = value["samples"];
  }
  return shown;
}

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

std::string Results::add(const std::string& family, Json row) {
  std::string name = name_of(family, row);
  Json whole{{"name", name}};
  for (const auto& [member, value] : row.items()) {
    const bool unknown =
        value.is_null() || (value.is_number_float() && !std::isfinite(value.get<double>()));
    if (!unknown) whole[member] = value;
  }
  std::deque<Json>& rows = families_[family];
  if (rows.empty()) order_.push_back(family);
  const auto at = std::find_if(rows.begin(), rows.end(),
                               [&](const Json& other) { return other["name"] == name; });
  if (at != rows.end()) {
    *at = std::move(whole);
  } else {
    rows.push_back(std::move(whole));
  }
  return name;
}

void Results::adopt(const Json& benchmarks) {
  adopted_.insert(adopted_.end(), benchmarks.begin(), benchmarks.end());
}

std::vector<const Json*> Results::rows(const std::string& family, const Json& where) const {
  std::vector<const Json*> found;
  const auto of = families_.find(family);
  if (of == families_.end()) return found;
  for (const Json& row : of->second) {
    if (matches(row, where)) found.push_back(&row);
  }
  return found;
}

const Json* Results::row(const std::string& family, const Json& where) const {
  const auto found = rows(family, where);
  return found.empty() ? nullptr : found.front();
}

Json Results::document() const {
  Json benchmarks = Json::array();
  for (const std::string& family : order_) {
    for (const Json& row : families_.at(family)) benchmarks.push_back(benchmark_of(family, row));
  }
  benchmarks.insert(benchmarks.end(), adopted_.begin(), adopted_.end());
  return {{"context", context_}, {"benchmarks", std::move(benchmarks)}};
}

std::string document_text(const Json& document) {
  const auto line = [](const Json& json, int indent) {
    return json.dump(indent, ' ', true, Json::error_handler_t::replace);
  };
  std::string text = "{\n\"context\": " + line(document["context"], 1) + ",\n\"benchmarks\": [";
  const char* before = "\n";
  for (const Json& row : document["benchmarks"]) {
    text += before + line(row, -1);
    before = ",\n";
  }
  return text + "\n]\n}\n";
}

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

std::vector<std::string> keys_of(const std::string& family) {
  return family_named(family)["keys"].get<std::vector<std::string>>();
}

std::string word_of(std::string_view text) {
  static const std::pair<std::regex, const char*> kRules[] = {
      {std::regex("[a-z](?=[A-Z])|[A-Z](?=[A-Z][a-z])"), "$&_"},  // words that are joined
      {std::regex(" ?%"), "_percent"},
      {std::regex("\\+"), "plus"},
      {std::regex("[()]"), ""},
      {std::regex("[ /:]"), "_"}};
  std::string word(text);
  for (const auto& [pattern, by] : kRules) word = std::regex_replace(word, pattern, by);
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word;
}

Json to_value(std::span<const double> samples) {
  if (samples.empty()) return nullptr;
  const Spread spread = spread_of(samples);
  return {{"min", spread.min},
          {"median", spread.median},
          {"max", spread.max},
          {"samples", samples.size()}};
}

double value_of(const Json& row, const std::string& name) {
  const auto at = row.find(name);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (at == row.end()) return kNone;
  if (at->is_number()) return at->get<double>();
  return at->is_object() ? at->value("median", kNone) : kNone;
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
