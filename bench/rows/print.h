#pragma once

#include "bench/rows/results.h"

#include <iosfwd>
#include <string>
#include <vector>

namespace winnow::bench {

/// Prints the rows of a family: the keys that all rows share in one line, then a column for each
/// other key and for each of these values (none: all) that any row has. Spreads are shown as median
/// (least to greatest). Prints nothing if there are no rows.
void print_rows(std::ostream& out, const Results& results, const std::string& family,
                const std::vector<std::string>& values = {});

}  // namespace winnow::bench
