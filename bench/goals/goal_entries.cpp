#include "bench/goals/goal_entries.h"

#include "bench/rows/template_text.h"

#include <algorithm>
#include <stdexcept>

namespace winnow::bench {
namespace {

/// Merges one object of each source, in every combination.
std::vector<Json> combinations(const Json& sources, const Json& lists) {
  std::vector<Json> all{Json::object()};
  for (const Json& source : sources) {
    const Json& objects = source.is_string() ? lists.at(source.get<std::string>()) : source;
    std::vector<Json> longer;
    for (const Json& before : all) {
      for (const Json& object : objects) {
        longer.push_back(before);
        longer.back().update(object);
      }
    }
    all = std::move(longer);
  }
  return all;
}

bool is_kept(const Json& object, const Json& only) {
  return std::all_of(only.items().begin(), only.items().end(), [&](const auto& member) {
    const Json& values = member.value();
    return std::find(values.begin(), values.end(), object.at(member.key())) != values.end();
  });
}

void check_entry(const Json& entry) {
  const std::string topic = entry.at("topic");
  if (std::find(kTopics.begin(), kTopics.end(), topic) == kTopics.end()) {
    throw std::runtime_error("goals.json: unknown topic " + topic);
  }
  for (const char* member : {"what", "unit", "measure", "value"}) {
    if (!entry.contains(member)) {
      throw std::runtime_error(std::string("goals.json: without \"") + member +
                               "\": " + entry.dump());
    }
  }
  if (entry.contains("at_most") == entry.contains("at_least")) {
    throw std::runtime_error("goals.json: exactly one bound is needed: " + entry.dump());
  }
}

}  // namespace

std::vector<Json> parse_goals(std::string_view text) {
  const Json document = Json::parse(text);
  std::vector<Json> entries;
  for (const Json& entry : document.at("goals")) {
    const Json only = entry.value("only", Json::object());
    for (const Json& object :
         combinations(entry.value("each", Json::array()), document.at("lists"))) {
      if (!is_kept(object, only)) continue;
      Json expanded = entry;
      expanded.erase("each");
      expanded.erase("only");
      entries.push_back(filled_in(expanded, object));
      check_entry(entries.back());
    }
  }
  return entries;
}

}  // namespace winnow::bench
