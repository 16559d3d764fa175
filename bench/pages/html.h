#pragma once

#include "bench/common/json.h"

#include <cstddef>
#include <string>

namespace winnow::bench {

[[nodiscard]] std::string replaced(std::string text, const std::string& what,
                                   const std::string& by);

/// Text as HTML shows it.
[[nodiscard]] std::string escaped(const std::string& text);

/// A script element; nothing in it looks like its end.
[[nodiscard]] std::string script_element(const std::string& text);

/// JSON within a page, for its scripts to read. Strings may be any bytes.
[[nodiscard]] std::string data_element(const std::string& id, const Json& value);

/// Writes a page; its size in bytes. Throws ArgumentError if it cannot be written.
std::size_t write_html(const std::string& path, const std::string& title, const std::string& style,
                       const std::string& body);

}  // namespace winnow::bench
