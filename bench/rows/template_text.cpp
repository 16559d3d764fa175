#include "bench/rows/template_text.h"

#include "bench/common/table.h"
#include "bench/rows/results.h"

namespace winnow::bench {
namespace {

/// Returns the value of "{member}" if that is the whole text; otherwise null.
const Json* whole_member(const std::string& text, const Json& object) {
  if (text.size() < 3 || text.front() != '{' || text.back() != '}') return nullptr;
  const auto at = object.find(text.substr(1, text.size() - 2));
  return at == object.end() ? nullptr : &*at;
}

}  // namespace

std::string member_text(const std::string& name, const Json& value) {
  if (name == "threads") return threads_text(value.get<int>());
  return value.is_number_unsigned() ? grouped(value.get<std::size_t>()) : key_text(value);
}

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

}  // namespace winnow::bench
