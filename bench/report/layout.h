#pragma once

#include "bench/common/json.h"
#include "bench/pages/plot_page.h"
#include "bench/rows/results.h"

#include <limits>
#include <string>
#include <vector>

namespace winnow::bench {

/// One cell of a table. A cell that shows a value names its row and the value.
struct Cell {
  std::string text;
  std::string row{};
  std::string value{};
  double number = std::numeric_limits<double>::quiet_NaN();  ///< the value, if it is a number
  bool best = false;
  bool words = false;  ///< text, set flush left and wrapped
};

struct CellTable {
  std::string caption{};
  std::vector<std::string> header{};
  std::vector<std::vector<Cell>> rows{};
};

/// Outputs in which a part is shown.
enum PartTarget : unsigned { kOnPage = 1, kInResults = 2, kOnTerminal = 4 };

/// One piece of a rendered report.
struct Part {
  enum class Kind { heading, paragraph, command, table, plot };
  Kind kind = Kind::paragraph;
  unsigned targets = kOnPage;
  std::string text{};
  CellTable table{};
  Plot plot{};
};

/// layout.json describes which results are shown: sections, each with "id" and "title" and "open"
/// if it is unfolded at first, and a block "readme". A block is an object with any of
///
///   "heading", "text"   left out if the block has other contents and these are all empty
///   "show": [blocks]
///   "pivot": "TABLE DOWN ACROSS VALUE...": a table for each value, with a row for each DOWN and a
///     column for each ACROSS; "caption" (the value's heading is "{label}"); the best cell of each
///     column is marked unless "best" is false; "most": VALUE adds the greatest of each row
///   "rows": TABLE: its rows as they are; "columns": keys, values, {"of": TABLE, "value", "label",
///     "where"} for a value of the row of another table with the same keys, and {"all": KEY,
///     "label"} for the KEYs of all rows that "once": [names] merged into one; default: all
///   "plot": "TABLE SERIES X Y...": points, joined by lines unless "dots": a series for each value
///     of the key SERIES, or, if that is "-", for each Y; whiskers if values are spreads; "log":
///     axes that are logarithmic, "x" and "y": their labels, "front": true for the Pareto front;
///     "title"
///   "bars": as "plot", with a bar for each X, stacked if SERIES is "-" or "stacked" is true
///   "least": [{"what", "of": "TABLE ENGINE VALUE", "unit", "own"}]: in each line the least value
///     of winnow (or of its engine "own") and of other libraries
///   "command": TABLE: the command that measures the first row again
///   "to": the targets, among "page", "results" and "terminal", that show tables and plots with
///     their headings and texts; default: the page
///   "each": {KEY: SOURCE, ...}: repeats the block for each combination; a source is a list of
///     values, or "TABLE" for the key's values in its rows, or "TABLE min", "TABLE max" or
///     "TABLE first" for one of these; "each" may also be a list of objects
///   "where": required members of the rows of all tables that the block names
///
/// The values that "each" binds, in this block and those around it, replace "{KEY}" in texts and
/// select the rows of tables that have this key. "isa" is bound to the active instruction set; a
/// null in "where" removes a binding.
extern const char* const kLayoutJson;

[[nodiscard]] const Json& layout();

/// Evaluates a block. Any part of the results may be missing. The ids of plots begin with `id`.
[[nodiscard]] std::vector<Part> parts_of(const Results& results, const Json& block,
                                         const std::string& id);

}  // namespace winnow::bench
