#include "bench/goals/asks.h"

#include "bench/common/table.h"
#include "bench/rows/results.h"

#include <algorithm>
#include <stdexcept>

namespace winnow::bench {
namespace {

std::string member_text(const std::string& name, const Json& value) {
  if (name == "threads") return threads_text(value.get<int>());
  return value.is_number_unsigned() ? grouped(value.get<std::size_t>()) : key_text(value);
}

/// The value that a text stands for which is "{member}" and nothing else; null if it is not.
const Json* whole_member(const std::string& text, const Json& object) {
  if (text.size() < 3 || text.front() != '{' || text.back() != '}') return nullptr;
  const auto at = object.find(text.substr(1, text.size() - 2));
  return at == object.end() ? nullptr : &*at;
}

Json filled_in(const Json& entry, const Json& object) {
  if (entry.is_string()) {
    const std::string text = entry;
    const Json* value = whole_member(text, object);
    return value != nullptr ? *value : Json(filled(text, object));
  }
  Json result = entry;
  if (entry.is_structured()) {
    for (Json& part : result) part = filled_in(part, object);
  }
  return result;
}

/// Every combination of one object of each source.
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

void check_ask(const Json& ask) {
  const std::string topic = ask.at("topic");
  if (std::find(kTopics.begin(), kTopics.end(), topic) == kTopics.end()) {
    throw std::runtime_error("goals.json: unknown topic " + topic);
  }
  for (const char* member : {"what", "unit", "measure", "value"}) {
    if (!ask.contains(member)) {
      throw std::runtime_error(std::string("goals.json: without \"") + member +
                               "\": " + ask.dump());
    }
  }
  if (ask.contains("at_most") == ask.contains("at_least")) {
    throw std::runtime_error("goals.json: one bound, please: " + ask.dump());
  }
}

}  // namespace

std::string filled(const std::string& text, const Json& object) {
  std::string result;
  std::size_t done = 0;
  for (std::size_t at = 0; (at = text.find('{', done)) != std::string::npos;) {
    const std::size_t end = text.find('}', at);
    if (end == std::string::npos) break;
    const std::string name = text.substr(at + 1, end - at - 1);
    const auto member = object.find(name);
    result += text.substr(done, at - done);
    result += member == object.end() ? "{" + name + "}" : member_text(name, *member);
    done = end + 1;
  }
  return result + text.substr(done);
}

std::vector<Json> parse_asks(std::string_view text) {
  const Json document = Json::parse(text);
  std::vector<Json> asks;
  for (const Json& entry : document.at("asks")) {
    const Json only = entry.value("only", Json::object());
    for (const Json& object :
         combinations(entry.value("each", Json::array()), document.at("lists"))) {
      if (!is_kept(object, only)) continue;
      Json ask = entry;
      ask.erase("each");
      ask.erase("only");
      asks.push_back(filled_in(ask, object));
      check_ask(asks.back());
    }
  }
  return asks;
}

}  // namespace winnow::bench
