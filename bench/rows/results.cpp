#include "bench/rows/results.h"

#include "bench/common/sample.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace winnow::bench {
namespace {

/// Keys of a family in the order of its names, and the value that becomes `real_time`.
struct Family {
  std::string_view name;
  const char* keys;
  std::string_view time = "";
};

constexpr std::array kFamilies = std::to_array<Family>({
    {"throughput", "scene objects threads partition isa", "frame_ms"},
    {"throughput_growth", "scene partition threads"},
    {"throughput_simd", "scene objects partition threads isa"},
    {"throughput_threads", "scene objects partition threads"},
    {"throughput_skipped", "objects skipped"},
    {"every_scene", "scene objects partition threads", "median_ms"},
    {"cold", "scene objects partition memory threads", "total_ms"},
    {"limits", "scene objects", "frame_ms"},
    {"hosts", "scene objects partition threads", "pool_ms"},
    {"memory", "scene objects partition threads"},
    {"memory_check", "scene objects partition threads by"},
    {"memory_ratio", "scene objects partition threads"},
    {"hard_cases", "family engine"},
    {"hard_cases_all", "engine answer"},
    {"barriers", "scene objects steps", "ms"},
    {"whole_scenes", "scene motion engine threads", "ms"},
    {"scene_ratios", "scene motion engine threads"},
    {"scene_levels", "scene level motion threads", "ms"},
    {"scene_costs", "scene level margin threads", "ms"},
    {"phases", "shape objects phase", "ms"},
    {"flows", "shape objects steps"},
    {"flow", "shape objects step"},
    {"flow_checks", "shape objects steps"},
    {"flow_frames", "shape objects how", "ms"},
    {"standing", "structure manifolds seconds"},
    {"cluster_runs", "scene objects ranks"},
    {"advice", "scene objects threads"},
    {"advice_ranking", "scene objects threads partition", "frame_ms"},
    {"worst_frames", "scene objects threads partition"},
    {"first_frames", "scene objects threads"},
    {"changes", "from into objects threads"},
    {"trust", "row figure"},
});

const Family& family_named(const std::string& name) {
  const auto at = std::find_if(kFamilies.begin(), kFamilies.end(),
                               [&](const Family& one) { return one.name == name; });
  if (at == kFamilies.end()) throw std::logic_error("no family of rows " + name);
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
Json benchmark_of(const Family& family, const Json& row) {
  Json shown{{"name", row["name"]}, {"run_name", row["name"]}, {"run_type", "iteration"},
             {"iterations", 1},     {"real_time", 0.0},        {"cpu_time", 0.0},
             {"time_unit", "ms"}};
  const auto keys = keys_of(std::string(family.name));
  for (const auto& [member, value] : row.items()) {
    if (member == "name" || std::find(keys.begin(), keys.end(), member) != keys.end()) continue;
    const bool is_time = member == family.time;
    const std::string name = is_time ? "real_time" : member;
    shown[name] = value.is_object() ? value["median"] : value;
    if (is_time) shown["cpu_time"] = shown[name];
    if (!value.is_object()) continue;
    shown[name + "_min"] = value["min"];
    shown[name + "_max"] = value["max"];
    if (is_time) shown["iterations"] = value["samples"];
  }
  return shown;
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
  for (const std::string& name : order_) {
    const Family& family = family_named(name);
    for (const Json& row : families_.at(name)) benchmarks.push_back(benchmark_of(family, row));
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

std::vector<std::string> keys_of(const std::string& family) {
  std::istringstream words(family_named(family).keys);
  std::vector<std::string> keys;
  for (std::string word; words >> word;) keys.push_back(word);
  return keys;
}

std::string word_of(std::string_view text) {
  const auto is = [&](std::size_t i, int (*kind)(int)) {
    return i < text.size() && kind(static_cast<unsigned char>(text[i])) != 0;
  };
  std::string word;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool starts =
        i > 0 && is(i, std::isupper) &&
        (is(i - 1, std::islower) || (is(i - 1, std::isupper) && is(i + 1, std::islower)));
    if (starts) word += '_';
    if (c == '%') {
      word += word.ends_with('_') ? "percent" : "_percent";
    } else if (c == '+') {
      word += "plus";
    } else if (c != '(' && c != ')') {
      word += c == ' ' || c == '/' || c == ':'
                  ? '_'
                  : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
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
