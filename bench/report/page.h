#pragma once

#include "bench/pages/plot_page.h"
#include "bench/rows/results.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// One cell of a table on the page. Where it shows a number, it says of which row and value.
struct PageCell {
  std::string text;
  std::string row{};
  std::string value{};
  bool best = false;
  bool words = false;  ///< set flush left, and broken into lines
};

struct PageTable {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<PageCell>> rows;
};

/// The parts of the page that a section is made of. Whatever shows a number is made from rows of
/// the results and says which: cells by `cell`, points by `series_of`. Texts are plain, but for
/// those called html.
class ReportPage {
 public:
  explicit ReportPage(const Results& results) : results_(results) {}

  void heading(const std::string& text);
  void paragraph(const std::string& text);
  /// How to measure what stands above it again.
  void command(const std::string& text);
  /// That of the first row of a table that has these members, if there is one.
  void command_of(const std::string& table, const Json& where);
  void add(const PageTable& table);
  /// Plots beside each other, where the page is wide enough. Their ids must be unique on the page;
  /// those without points are left out.
  void add(const std::vector<Plot>& plots);
  /// Every row of a table of the results, folded away on the screen and left out in print, for
  /// which it is too wide: that is what the CSVs are for.
  void all_rows(const std::string& table);

  [[nodiscard]] const Results& results() const noexcept { return results_; }
  [[nodiscard]] const std::string& html() const noexcept { return html_; }
  [[nodiscard]] const std::vector<Plot>& plots() const noexcept { return plots_; }

 private:
  const Results& results_;
  std::string html_;
  std::vector<Plot> plots_;
};

/// A text.
[[nodiscard]] PageCell text_cell(const std::string& text);
/// A value of a row (null: "-"), as its column says; spreads show their median.
[[nodiscard]] PageCell cell(const Results& results, const std::string& table, const Json* row,
                            const std::string& value);

/// A table of one value: a row for each `row_key`, a column for each `column_key`, of the rows that
/// have the members of `where` and the value.
struct Pivot {
  std::string table;
  Json where = Json::object();
  std::string row_key;
  std::string column_key;
  std::string value;
  std::string caption{};  ///< empty: the column's label and unit
  bool mark_best = true;  ///< in each column, if one way is better
};
[[nodiscard]] PageTable pivot(const Results& results, const Pivot& pivot);

/// Series of a plot: one for each text of `series_key`, of the rows that have the members of
/// `where`, with x and y from a numeric key or a value. Spreads have whiskers. Rows without x or y,
/// or not above 0 on a logarithmic axis, are left out.
struct SeriesOf {
  std::string table;
  Json where = Json::object();
  std::string series_key;
  std::string x;
  std::string y;
  bool line = true;
};
[[nodiscard]] std::vector<PlotSeries> series_of(const Results& results, const SeriesOf& from,
                                                bool log_x, bool log_y);

/// A bar for each text of `category_key`, stacked of values of its row: a series for each of them.
struct BarsOf {
  std::string table;
  Json where = Json::object();
  std::string category_key;
  std::vector<std::string> values;
};
void add_bars(Plot& plot, const Results& results, const BarsOf& from);

/// Bars beside each other: a group for each text of `category_key`, in it a bar for each text of
/// `series_key`.
struct BarGroupsOf {
  std::string table;
  Json where = Json::object();
  std::string category_key;
  std::string series_key;
  std::string value;
};
void add_bar_groups(Plot& plot, const Results& results, const BarGroupsOf& from);

/// The series of the points of which no other has both less x and less y.
[[nodiscard]] PlotSeries pareto_front(const std::vector<PlotSeries>& series);

/// The whole page: what was measured where, how far it got, what is missing, and every section.
/// Throws ArgumentError if it cannot be written.
void write_report_page(const std::string& path, const Results& results);

}  // namespace winnow::bench
