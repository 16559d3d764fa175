#pragma once

#include "bench/common/json.h"

#include <string>

namespace winnow::bench {

/// Formats a report's table as CSV (RFC 4180), with one column for each key and value, and three
/// columns (min, median, max) for a value with a spread.
[[nodiscard]] std::string to_csv(const Json& table);

}  // namespace winnow::bench
