#pragma once

#include "bench/common/json.h"

#include <cstddef>
#include <string>

namespace winnow::bench {

// Pages, with their own scripts and styles; pages.cmake embeds them.
extern const char* const kResultsPage;
extern const char* const kDrawPage;

/// Writes a file. Throws ArgumentError if that fails.
void write_text(const std::string& path, const std::string& text);

/// Writes a self-contained page (no network, no other files) that shows the data, and returns its
/// size in bytes. Scripts with an absolute path, which are libraries, are read from there. Equal
/// data give equal bytes. Throws ArgumentError if a library is not installed, with Debian's
/// package, or if the file cannot be written.
std::size_t write_page(const std::string& path, const char* page, const Json& data);

}  // namespace winnow::bench
