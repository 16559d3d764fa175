#include "simulation/flow_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>

namespace winnow::bench {
namespace {

constexpr double kWidth = 860.0;
constexpr double kHeight = 230.0;
constexpr double kLeft = 90.0;
constexpr double kBottom = 26.0;
/// Points of a line; of more steps, every so many-th is shown.
constexpr std::size_t kMostPoints = 800;

struct Line {
  const char* name;
  const char* colour;
  double (*value)(const FlowSample&);
  bool profiled_only = false;
};

struct Plot {
  const char* title;
  std::vector<Line> lines;
  /// What is above nearly all values is cut off: times, which the machine disturbs.
  bool cut = false;
};

std::vector<Plot> plots() {
  return {
      {"Energy",
       {{"kinetic", "#2c6fbb", [](const FlowSample& s) { return s.energy.kinetic; }},
        {"potential", "#7a7a7a", [](const FlowSample& s) { return s.energy.potential; }},
        {"in contacts", "#c4572e", [](const FlowSample& s) { return s.energy.elastic; }},
        {"all, without what putting back adds: never rises", "#1d8348",
         [](const FlowSample& s) { return s.balance(); }}}},
      {"Kinetic energy, and energy in contacts",
       {{"kinetic", "#2c6fbb", [](const FlowSample& s) { return s.energy.kinetic; }},
        {"in contacts", "#c4572e", [](const FlowSample& s) { return s.energy.elastic; }}}},
      {"Greatest penetration (bodies are about 1 across)",
       {{"depth", "#c4572e", [](const FlowSample& s) { return s.deepest; }}}},
      {"Contacts",
       {{"pairs", "#2c6fbb", [](const FlowSample& s) { return static_cast<double>(s.contacts); }},
        {"points", "#7a7a7a", [](const FlowSample& s) { return static_cast<double>(s.points); }}}},
      {"Milliseconds a step",
       {{"all", "#7a7a7a", [](const FlowSample& s) { return s.times.total(); }},
        {"broad phase", "#2c6fbb", [](const FlowSample& s) { return s.times.broad; }, true},
        {"mid phase", "#8e44ad", [](const FlowSample& s) { return s.times.mid; }, true},
        {"narrow phase", "#c4572e", [](const FlowSample& s) { return s.times.narrow; }, true},
        {"solver", "#1d8348", [](const FlowSample& s) { return s.times.solver; }}},
       true},
  };
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

struct Range {
  double low = 0.0;
  double high = 0.0;

  void take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double share(double value) const {
    return high > low ? (value - low) / (high - low) : 0.0;
  }
};

double x_at(const Range& times, double time) {
  return kLeft + (kWidth - kLeft) * times.share(time);
}
double y_at(const Range& values, double value) {
  return (kHeight - kBottom) * (1.0 - 0.95 * std::min(1.0, values.share(value)));
}

std::string axes(const Range& times, const Range& values) {
  constexpr int kLines = 5;
  std::string svg;
  for (int i = 0; i < kLines; ++i) {
    const double share = static_cast<double>(i) / (kLines - 1);
    const double value = std::lerp(values.low, values.high, share);
    const double time = std::lerp(times.low, times.high, share);
    const std::string y = number(y_at(values, value));
    svg += "<line x1=\"" + number(kLeft) + "\" x2=\"" + number(kWidth) + "\" y1=\"" + y +
           "\" y2=\"" + y + "\" stroke=\"#ddd\"/>\n<text x=\"" + number(kLeft - 6) + "\" y=\"" + y +
           "\" text-anchor=\"end\">" + number(value) + "</text>\n<text x=\"" +
           number(x_at(times, time)) + "\" y=\"" + number(kHeight - 6) +
           "\" text-anchor=\"middle\">" + number(time) + " s</text>\n";
  }
  return svg;
}

/// Of the plot's first line, which is the highest.
double nearly_most(const Plot& plot, const std::vector<FlowSample>& samples) {
  std::vector<double> values;
  for (const FlowSample& sample : samples) values.push_back(plot.lines.front().value(sample));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 9 / 10);
  if (at == values.end()) return 0.0;
  std::nth_element(values.begin(), at, values.end());
  return 1.5 * *at;
}

std::string draw(const Plot& plot, const std::vector<FlowSample>& samples) {
  Range times;
  Range values;
  for (const FlowSample& sample : samples) {
    times.take(sample.time);
    for (const Line& line : plot.lines) values.take(line.value(sample));
  }
  if (plot.cut) values.high = std::min(values.high, nearly_most(plot, samples));
  std::string svg = std::string("<h2>") + plot.title + "</h2>\n<p>";
  for (const Line& line : plot.lines) {
    svg += std::string("<span style=\"color:") + line.colour + "\">&#9632; " + line.name +
           "</span> &nbsp; ";
  }
  svg += "</p>\n<svg viewBox=\"0 0 " + number(kWidth + 30) + " " + number(kHeight) + "\">\n" +
         axes(times, values);
  for (const Line& line : plot.lines) {
    std::vector<const FlowSample*> shown;
    for (const FlowSample& sample : samples) {
      if (!line.profiled_only || sample.times.profiled) shown.push_back(&sample);
    }
    const std::size_t stride = shown.size() / kMostPoints + 1;
    svg += std::string("<polyline fill=\"none\" stroke=\"") + line.colour + "\" points=\"";
    for (std::size_t i = 0; i < shown.size(); i += stride) {
      svg += number(x_at(times, shown[i]->time)) + "," +
             number(y_at(values, line.value(*shown[i]))) + " ";
    }
    svg += "\"/>\n";
  }
  return svg + "</svg>\n";
}

}  // namespace

std::string flow_page(const FlowHistory& history, const FlowFacts& facts) {
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<title>winnow simulate</title>\n<style>\n"
      "body { font: 15px sans-serif; max-width: 900px; margin: 2em auto; color: #222; }\n"
      "h2 { font-size: 16px; margin: 1.6em 0 0.2em; }\np { margin: 0.2em 0; }\n"
      "text { font: 11px sans-serif; fill: #555; }\ntd { padding: 2px 18px 2px 0; }\n"
      "</style>\n</head>\n<body>\n<h1>Granular flow</h1>\n<table>\n";
  for (const auto& [what, much] : facts) {
    page += "<tr><td>" + escaped(what) + "</td><td>" + escaped(much) + "</td></tr>\n";
  }
  page += "</table>\n";
  for (const Plot& plot : plots()) page += draw(plot, history.samples());
  return page + "</body>\n</html>\n";
}

}  // namespace winnow::bench
