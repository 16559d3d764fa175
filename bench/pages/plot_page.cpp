#include "bench/pages/plot_page.h"

#include "bench/common/errors.h"
#include "bench/contenders/partitions.h"
#include "bench/pages/html.h"
#include "bench/pages/plot_parts.h"

#include <cerrno>
#include <cmath>
#include <cstring>
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
  // Partitions have the same colours on all pages.
  Json data{{"names", Json::array()}, {"plots", Json::array()}};
  for (const std::string& name : all_partitions()) data["names"].push_back(name);
  for (const Plot& plot : plots) data["plots"].push_back(plot_json(plot));
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  page += "<meta name=\"viewport\" content=\"width=device-width\">\n";
  page += "<title>" + escaped(title) + "</title>\n<style>\n" + kPlotStyle + "</style>\n</head>\n";
  page += "<body>\n" + body + kChartJsNotice;
  page += script_element(chart_js());
  page += data_element("plots", data);
  page += script_element(std::string("(() => {\n\"use strict\";\n") + kPlotScript + "})();");
  page += "</body>\n</html>\n";
  std::ofstream file(path, std::ios::binary);
  file << page;
  file.close();
  if (!file) throw ArgumentError("cannot write " + path + ": " + std::strerror(errno));
}

}  // namespace winnow::bench
