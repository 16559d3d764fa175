#pragma once

#include <limits>
#include <string>
#include <vector>

namespace winnow::bench {

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
  std::string note{};  ///< tooltip
  std::string row{};   ///< id of the row that the point shows; not displayed
  /// Ends of the whisker; NaN for none.
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

struct PlotSeries {
  std::string name;  ///< equal names have one colour on the whole page
  std::vector<PlotPoint> points{};
  bool line = true;
  std::string x_value{};  ///< names of the values x and y in the rows of the points
  std::string y_value{};
  bool front = false;  ///< a Pareto front: a thin dashed line without marks
};

struct PlotAxis {
  std::string label;  ///< includes the unit
  bool log = false;
};

struct Plot {
  std::string id;  ///< of the element, unique on the page
  std::string title;
  PlotAxis x;
  PlotAxis y;
  std::vector<PlotSeries> series{};
  /// If not empty, the plot has one bar, or one stack, per category, and x is the category's index.
  std::vector<std::string> categories{};
  bool stacked = true;  ///< stacks the bars of a category instead of placing them side by side
};

/// Returns the HTML element that marks the place of a plot in a page's body.
[[nodiscard]] std::string place_of(const Plot& plot);

/// Writes one self-contained HTML page (no network, no other files). `body` is HTML with a
/// `place_of` each plot. Throws ArgumentError if Chart.js is not installed, with the package to
/// install, or if the file cannot be written.
void write_plot_page(const std::string& path, const std::string& title, const std::string& body,
                     const std::vector<Plot>& plots);

}  // namespace winnow::bench
