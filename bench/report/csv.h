#pragma once

#include "bench/common/json.h"

#include <string>

namespace winnow::bench {

/// A table of a report as CSV (RFC 4180): a column a key and a value, three (min, median, max)
/// where a row has a spread.
[[nodiscard]] std::string to_csv(const Json& table);

}  // namespace winnow::bench
