#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

namespace winnow::bench {

/// Members stay in the order in which they are written.
using Json = nlohmann::ordered_json;

/// Lists and objects in each other at most, in files of others: what compares and copies values
/// goes down them by calling itself.
inline constexpr std::size_t kDeepestJson = 200;

/// Of a file that anybody may have written. Throws ArgumentError, with the file and what is wrong
/// where, if it cannot be read, is no JSON or is nested deeper than kDeepestJson.
[[nodiscard]] Json read_json(const std::string& path);

/// The member, or null if there is none or `value` is no object.
[[nodiscard]] inline const Json& member(const Json& value, const char* name) {
  static const Json nothing;
  const auto at = value.find(name);
  return at == value.end() ? nothing : *at;
}
/// The element, or null if there is none or `value` is no list.
[[nodiscard]] inline const Json& element(const Json& value, std::size_t i) {
  static const Json nothing;
  return value.is_array() && i < value.size() ? value[i] : nothing;
}

/// Writes to a file; does nothing for an empty path. Throws ArgumentError if it cannot.
void write_json(const std::string& path, const Json& value);

}  // namespace winnow::bench
