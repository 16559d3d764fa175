#pragma once

#include "bench/common/json.h"

#include <string>

namespace winnow::bench {

/// Writes one HTML page that shows an array of pictures, one after the other, and needs nothing
/// else: no network, no other file. The same pictures give the same bytes. Returns the page's size.
/// Throws ArgumentError if three.js is not installed, saying how to get it, or the file cannot be
/// written.
std::size_t write_page(const std::string& path, const Json& pictures);

}  // namespace winnow::bench
