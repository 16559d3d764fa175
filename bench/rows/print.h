#pragma once

#include "bench/rows/results.h"

#include <iosfwd>
#include <string>
#include <vector>

namespace winnow::bench {

/// Prints the rows of a table: the keys that all rows share in one line, then a column for each
/// other key and for each of these values (none: all) that any row has. Spreads are shown as median
/// (least to greatest). Prints nothing if there are no rows.
void print_rows(std::ostream& out, const Results& results, const std::string& table,
                const std::vector<std::string>& values = {});

/// Returns the rows of all tables in one array.
[[nodiscard]] Json all_rows_of(const Results& results);

}  // namespace winnow::bench
