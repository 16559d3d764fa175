#pragma once

#include "bench/common/json.h"
#include "bench/pages/plot_page.h"
#include "bench/rows/results.h"

#include <limits>
#include <string>
#include <vector>

namespace winnow::bench {

/// One cell of a table. Where it shows a value of a row, it says of which.
struct Cell {
  std::string text;
  std::string row{};
  std::string value{};
  double number = std::numeric_limits<double>::quiet_NaN();  ///< of the value, if it is one
  bool best = false;
  bool words = false;  ///< set flush left, and broken into lines
};

struct CellTable {
  std::string caption{};
  std::vector<std::string> header{};
  std::vector<std::vector<Cell>> rows{};
};

/// Where a part is shown.
enum PartTarget : unsigned { kOnPage = 1, kInResults = 2, kOnTerminal = 4 };

/// What a reader sees, piece by piece.
struct Part {
  enum class Kind { heading, paragraph, command, table, plot };
  Kind kind = Kind::paragraph;
  unsigned targets = kOnPage;
  std::string text{};
  CellTable table{};
  Plot plot{};
};

/// What is shown of the results is described in layout.json: sections, each with "id" and "title",
/// and "open" if it is not folded away, and a block "readme". A block is an object with any of
///
///   "heading", "text"   left out if the block has other contents, and these show nothing
///   "show": [blocks]
///   "pivot": "TABLE DOWN ACROSS VALUE...": for each value a table, a row for each DOWN, a column
///     for each ACROSS; "caption" (the value's heading is "{label}"); the best of each column is
///     marked unless "best" is false; "most": VALUE adds the greatest of each row
///   "rows": TABLE: its rows as they are; "columns": keys, values, {"of": TABLE, "value", "label",
///     "where"} for a value of the row of another table with the same keys, and {"all": KEY,
///     "label"} for all that "once": [names] made one row of; without columns, everything
///   "plot": "TABLE SERIES X Y...": points, joined by lines unless "dots": a series for each text
///     of the key SERIES, or, if that is "-", for each Y; whiskers where values are spreads; "log":
///     axes that are logarithmic, "x" and "y": their labels, "front": true for the border that no
///     point lies below; "title"
///   "bars": the same, a bar for each X, stacked if SERIES is "-" or with "stacked": true
///   "least": [{"what", "of": "TABLE ENGINE VALUE", "unit", "own"}]: in each line the least of
///     winnow (or of its engine "own") and of other libraries
///   "command": TABLE: how the first row is measured again
///   "to": those of "page", "results" and "terminal" where tables and plots are shown, and with
///     them their headings and texts; default: the page
///   "each": {KEY: SOURCE, ...}: the block once for each combination; a source is a list of values
///     or "TABLE", the texts of the key among its rows, or "TABLE min", "max", "first"; or a list
///     of objects
///   "where": members of the rows of any table that the block names
///
/// What "each" of this block and those about it has bound is filled into texts as "{KEY}", and
/// narrows down the rows of tables that have such a key; "isa" is bound to the active instruction
/// set, and "where" undoes that with null.
extern const char* const kLayoutJson;

[[nodiscard]] const Json& layout();

/// All parts of a block, of results of which any part may be missing. `id`: what the ids of plots
/// begin with.
[[nodiscard]] std::vector<Part> parts_of(const Results& results, const Json& block,
                                         const std::string& id);

}  // namespace winnow::bench
