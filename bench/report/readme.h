#pragma once

#include "report/results.h"

#include <string>

namespace winnow::bench {

/// A text with what stands between each "<!-- table NAME -->" and "<!-- end of table -->" made of
/// the results. Tables and paragraphs are described in readme.json:
///
///   {"name", "table",
///    "where",                       members of rows; of a list any; "@isa" is the active one
///    "corner",                      what is headed above the rows' names
///    "rows": {"key"} or [{"head"}], one for each text of a key, or those told
///    "columns": [{"each"} or {"head"}]}
///   {"name", "table", "where", "text"}, a paragraph
///
/// Rows and columns may have "where" and "table" too; one of both has a "cell". Cells and texts are
/// lists of texts and figures: {"value", "where", "table"} of one row, with "least" or "most": true
/// of that which has the least or most, with "sum": true of all of them; or {"machine": a fact}.
/// What a figure does not say it has from its column, row and table. Throws ArgumentError at a name
/// that is not known or a table without end or figures.
[[nodiscard]] std::string readme_with_tables(const std::string& readme, const Results& results);

}  // namespace winnow::bench
