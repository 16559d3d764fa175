#pragma once

#include "bench/common/json.h"

#include <cstddef>
#include <string>

namespace winnow::bench {

[[nodiscard]] std::string replaced(std::string text, const std::string& what,
                                   const std::string& by);

/// Returns the text with HTML escapes.
[[nodiscard]] std::string escaped(const std::string& text);

/// Returns a script element; its text is escaped so that it cannot close the element.
[[nodiscard]] std::string script_element(const std::string& text);

/// Returns an element with JSON for the scripts of the page. Strings may contain any bytes.
[[nodiscard]] std::string data_element(const std::string& id, const Json& value);

/// Writes a page and returns its size in bytes. Throws ArgumentError if it cannot be written.
std::size_t write_html(const std::string& path, const std::string& title, const std::string& style,
                       const std::string& body);

}  // namespace winnow::bench
