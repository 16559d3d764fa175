#include "plots/plot_page.h"

#include "plots/plot_parts.h"
#include "tool/command.h"
#include "tool/html.h"

#include <cerrno>
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

Json plot_json(const Plot& plot) {
  Json series = Json::array();
  for (const PlotSeries& one : plot.series) {
    Json points = Json::array();
    for (const PlotPoint& point : one.points) {
      points.push_back({{"x", point.x}, {"y", point.y}, {"note", point.note}});
    }
    series.push_back({{"name", one.name}, {"line", one.line}, {"points", std::move(points)}});
  }
  return {{"id", plot.id},
          {"title", plot.title},
          {"x", axis_json(plot.x)},
          {"y", axis_json(plot.y)},
          {"series", std::move(series)}};
}

}  // namespace

std::string place_of(const Plot& plot) {
  return "<div class=\"plot\"><canvas id=\"" + plot.id + "\"></canvas></div>\n";
}

void write_plot_page(const std::string& path, const std::string& title, const std::string& body,
                     const std::vector<Plot>& plots) {
  Json data{{"plots", Json::array()}};
  for (const Plot& plot : plots) data["plots"].push_back(plot_json(plot));
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
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
