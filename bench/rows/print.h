#pragma once

#include "bench/rows/results.h"

#include <iosfwd>
#include <string>
#include <vector>

namespace winnow::bench {

/// The rows of a table as text: what all of them share in one line, then a column for each key that
/// tells them apart and for each of these values (none: all) that any of them has. Spreads are
/// shown as median (least to greatest). Nothing if there are no rows.
void print_rows(std::ostream& out, const Results& results, const std::string& table,
                const std::vector<std::string>& values = {});

/// The rows of all tables, in one array.
[[nodiscard]] Json all_rows_of(const Results& results);

}  // namespace winnow::bench
