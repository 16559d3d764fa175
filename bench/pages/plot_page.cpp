#include "bench/pages/plot_page.h"

#include "bench/common/errors.h"
#include "bench/contenders/partitions.h"
#include "bench/pages/html.h"
#include "bench/pages/plot_parts.h"

#include <cmath>
#include <fstream>
#include <iterator>

namespace winnow::bench {
namespace {

std::string chart_js() {
  std::ifstream file(kChartJsFile, std::ios::binary);
  if (!file) {
    throw ArgumentError(std::string("plots need Chart.js, and ") + kChartJsFile +
                        " is not there. On Debian:\n  apt-get install -y libjs-chart.js");
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

Json axis_json(const PlotAxis& axis) {
  return {{"label", axis.label}, {"log", axis.log}};
}

Json point_json(const PlotPoint& point) {
  Json json{{"x", point.x}, {"y", point.y}, {"note", point.note}};
  if (!point.row.empty()) json["row"] = point.row;
  if (std::isfinite(point.low) && std::isfinite(point.high)) {
    json["low"] = point.low;
    json["high"] = point.high;
  }
  return json;
}

Json plot_json(const Plot& plot) {
  Json series = Json::array();
  for (const PlotSeries& one : plot.series) {
    Json points = Json::array();
    for (const PlotPoint& point : one.points) points.push_back(point_json(point));
    series.push_back({{"name", one.name},
                      {"line", one.line},
                      {"front", one.front},
                      {"x_value", one.x_value},
                      {"y_value", one.y_value},
                      {"points", std::move(points)}});
  }
  return {{"id", plot.id},
          {"title", plot.title},
          {"x", axis_json(plot.x)},
          {"y", axis_json(plot.y)},
          {"categories", plot.categories},
          {"stacked", plot.stacked},
          {"series", std::move(series)}};
}

}  // namespace

std::string place_of(const Plot& plot) {
  return "<div class=\"plot\"><canvas id=\"" + replaced(escaped(plot.id), "\"", "&quot;") +
         "\"></canvas></div>\n";
}

void write_plot_page(const std::string& path, const std::string& title, const std::string& body,
                     const std::vector<Plot>& plots) {
  // All partitions are listed, so that each has the same colour on all pages.
  Json data{{"names", Json::array()}, {"plots", Json::array()}};
  for (const std::string& name : all_partitions()) data["names"].push_back(name);
  for (const Plot& plot : plots) data["plots"].push_back(plot_json(plot));
  const std::string script = std::string("(() => {\n\"use strict\";\n") + kPlotScript + "})();";
  write_html(path, title, kPlotStyle,
             body + kChartJsNotice + script_element(chart_js()) + data_element("plots", data) +
                 script_element(script));
}

}  // namespace winnow::bench
