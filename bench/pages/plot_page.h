#pragma once

#include <limits>
#include <string>
#include <vector>

namespace winnow::bench {

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
  std::string note{};  ///< shown where the pointer is
  std::string row{};   ///< what it was made from, for who reads the page's data
  /// Ends of the whisker; NaN: there is none.
  double low = std::numeric_limits<double>::quiet_NaN();
  double high = std::numeric_limits<double>::quiet_NaN();
};

struct PlotSeries {
  std::string name;  ///< one name has one colour on the whole page
  std::vector<PlotPoint> points{};
  bool line = true;
  std::string x_value{};  ///< names of what x and y are in the rows of the points
  std::string y_value{};
  bool front = false;  ///< a border between points: a thin black line without marks
};

struct PlotAxis {
  std::string label;  ///< with its unit
  bool log = false;
};

struct Plot {
  std::string id;  ///< of the element, unique on the page
  std::string title;
  PlotAxis x;
  PlotAxis y;
  std::vector<PlotSeries> series{};
  /// If there are any, the plot has bars, one for each of these; x is its number.
  std::vector<std::string> categories{};
  bool stacked = true;  ///< bars of one category; otherwise they stand beside each other
};

/// Where a plot is to stand within a page's body.
[[nodiscard]] std::string place_of(const Plot& plot);

/// Writes one HTML page that needs nothing else: no network, no other file. `body` is HTML and has
/// a place for each plot. Throws ArgumentError if Chart.js is not installed, saying how to get it,
/// or the file cannot be written.
void write_plot_page(const std::string& path, const std::string& title, const std::string& body,
                     const std::vector<Plot>& plots);

}  // namespace winnow::bench
