#pragma once

#include "bench/common/json.h"

#include <string>

namespace winnow::bench {

/// Formats a report's table as CSV (RFC 4180), with one column for each key and value. A value with
/// a spread has three columns (min, median, max).
[[nodiscard]] std::string to_csv(const Json& table);

}  // namespace winnow::bench
