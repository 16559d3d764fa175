#pragma once

#include "bench/common/json.h"

#include <string>

namespace winnow::bench {

/// Writes one self-contained HTML page (no network, no other files) that shows an array of pictures
/// one at a time. Equal pictures give equal bytes. Returns the size of the page in bytes. Throws
/// ArgumentError if three.js is not installed, with the package to install, or if the file cannot
/// be written.
std::size_t write_page(const std::string& path, const Json& pictures);

}  // namespace winnow::bench
