#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

namespace winnow::bench {

/// Keeps members in the order of insertion.
using Json = nlohmann::ordered_json;

/// Deepest nesting accepted from a file: comparing and copying values recurses once per level, and
/// a deeper file could overflow the stack.
inline constexpr std::size_t kDeepestJson = 200;

/// Reads an untrusted file. Throws ArgumentError with the path and the error if it cannot be read,
/// is not JSON or is nested deeper than kDeepestJson.
[[nodiscard]] Json read_json(const std::string& path);

/// Returns the member, or null if it is missing or `value` is not an object.
[[nodiscard]] inline const Json& member(const Json& value, const char* name) {
  static const Json nothing;
  const auto at = value.find(name);
  return at == value.end() ? nothing : *at;
}
/// Returns the element, or null if it is missing or `value` is not a list.
[[nodiscard]] inline const Json& element(const Json& value, std::size_t i) {
  static const Json nothing;
  return value.is_array() && i < value.size() ? value[i] : nothing;
}

/// Writes to a file; does nothing for an empty path. Throws ArgumentError if the file cannot be
/// written.
void write_json(const std::string& path, const Json& value);

}  // namespace winnow::bench
