#include "engine/fingerprint.h"
#include "report/sections/pipeline.h"
#include "simulation/flow_history.h"
#include "tool/table.h"

#include <algorithm>
#include <utility>

namespace winnow::bench {
namespace {

constexpr std::pair<const char*, FlowShape> kFlowShapes[] = {
    {"spheres", FlowShape::spheres}, {"mixed", FlowShape::mixed}, {"boxes", FlowShape::boxes}};
/// Steps of a flow that are kept.
constexpr std::size_t kFlowRows = 200;

/// One flow on one thread.
struct FlowCell {
  ReportOptions options{};
  std::string shape_name{};
  FlowShape shape = FlowShape::mixed;
  std::size_t objects = 500;
  std::size_t steps = 3000;

  void measure(Results& results) const;

 private:
  [[nodiscard]] Json with_keys(Json row) const;
  void add_phases(Results& results, const FlowHistory& history) const;
  void add_samples(Results& results, const FlowHistory& history) const;
};

Json FlowCell::with_keys(Json row) const {
  row["shape"] = shape_name;
  row["objects"] = objects;
  row["command"] = "bench/run simulate --shape " + shape_name + " --objects " +
                   std::to_string(objects) + " --steps " + std::to_string(steps) +
                   " --threads 1 --seed " + std::to_string(options.seed) + " --isa " + isa_name();
  return row;
}

/// Of the second half, when bodies lie upon each other.
void FlowCell::add_phases(Results& results, const FlowHistory& history) const {
  std::vector<std::pair<Json, std::string>> added;
  double sum = 0.0;
  for (const FlowPhase& phase : kFlowPhases) {
    Json row =
        with_keys({{"phase", phase.name}, {"ms", to_value(history.phase_ms(phase.ms, steps / 2))}});
    sum += value_of(row, "ms");
    std::string id = results.add("phases", row);
    added.emplace_back(std::move(row), std::move(id));
  }
  for (const auto& [row, id] : added) {
    std::vector<std::string> from{id};
    for (const auto& other : added) {
      if (other.second != id) from.push_back(other.second);
    }
    Json with_share = row;
    with_share["share"] = value_of(row, "ms") / sum;
    with_share["from"] = derived("share", "share", "ms", from);
    results.add("phases", std::move(with_share));
  }
}

void FlowCell::add_samples(Results& results, const FlowHistory& history) const {
  const std::vector<FlowSample>& samples = history.samples();
  const std::size_t every = std::max<std::size_t>(1, samples.size() / kFlowRows);
  for (std::size_t i = 0; i < samples.size(); i += every) {
    const FlowSample& sample = samples[i];
    results.add("flow", with_keys({{"step", i + 1},
                                   {"seconds", sample.time},
                                   {"kinetic", sample.energy.kinetic},
                                   {"potential", sample.energy.potential},
                                   {"elastic", sample.energy.elastic},
                                   {"balance", sample.balance()},
                                   {"deepest", sample.deepest},
                                   {"pairs", sample.contacts},
                                   {"points", sample.points}}));
  }
}

void FlowCell::measure(Results& results) const {
  FlowOptions flow_options;
  flow_options.objects = objects;
  flow_options.shape = shape;
  flow_options.seed = options.seed;
  flow_options.execution = Execution::serial();
  GranularFlow flow(flow_options);
  FlowHistory history;
  for (std::size_t i = 0; i < steps; ++i) {
    flow.step(i % kProfiledSteps == 0);
    history.add(flow);
  }
  add_phases(results, history);
  add_samples(results, history);
  const FlowSample& last = history.samples().back();
  results.add("flows", with_keys({{"steps", flow.steps()},
                                  {"rise", history.greatest_rise()},
                                  {"deepest", history.deepest()},
                                  {"pairs", last.contacts},
                                  {"points", last.points},
                                  {"fingerprint", to_hex(flow.fingerprint())}}));
}

/// A line for each of these values of the rows of `flow`.
std::vector<PlotSeries> flow_lines(const Results& results, const Json& shape,
                                   const std::vector<std::string>& values) {
  std::vector<PlotSeries> lines;
  for (const std::string& value : values) {
    for (PlotSeries& line : series_of(
             results, {"flow", {{"shape", shape}}, "shape", "seconds", value}, false, false)) {
      line.name = (*results.column("flow", value))["label"];
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

/// Stacked bars of a value of the phases, one bar for each shape.
Plot phase_bars(const Results& results, const std::string& value, const std::string& title) {
  const Json* column = results.column("phases", value);
  const std::string unit = column != nullptr ? (*column)["unit"].get<std::string>() : "";
  Plot plot{.id = "phases_" + value,
            .title = title,
            .x = {"what falls", false},
            .y = {unit.empty() ? "share of a step" : unit + " a step", false}};
  if (column == nullptr) return plot;
  const auto rows = results.rows("phases");
  const auto shapes = distinct(rows, "shape");
  for (const Json& shape : shapes) plot.categories.push_back(key_text(shape));
  for (const Json& phase : distinct(rows, "phase")) {
    PlotSeries series{.name = key_text(phase)};
    series.y_value = value;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const Json* row = results.row("phases", {{"shape", shapes[i]}, {"phase", phase}});
      if (row == nullptr || !row->contains(value)) continue;
      series.points.push_back({static_cast<double>(i), value_of(*row, value),
                               shown(*row, *column) + " " + unit, (*row)["id"]});
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

void show_phases(const Results& results, ReportPage& page) {
  if (results.rows("phases").empty()) return;
  page.heading("A simulation that embeds winnow: where the time of a step goes");
  page.paragraph(
      "Spheres and boxes fall through a funnel made of triangles, with soft contacts and friction. "
      "Handing over poses: telling winnow where bodies are now. "
      "Broad phase: which boxes overlap. Mid phase: which triangles of the funnel each body "
      "meets. Narrow phase: contact points. Solver: forces and motion, which are the simulation's "
      "own.");
  page.add({phase_bars(results, "ms", "a step by phases"),
            phase_bars(results, "share", "shares of the phases")});
  page.command((*results.rows("phases").front())["command"]);
  page.add(pivot(results, {"phases", Json::object(), "phase", "shape", "ms", "ms a step", false}));
  page.add(pivot(results, {"phases", Json::object(), "phase", "shape", "share", "", false}));
}

}  // namespace

void declare_flows(Results& results) {
  results.declare({"phases",
                   "pipeline",
                   "phases of a step of the granular flow",
                   {"shape", "objects", "phase"},
                   {{"ms", "time", "ms", Better::less},
                    {"share", "share of a step", "", Better::neither, Format::percent}}});
  results.declare({"flows",
                   "pipeline",
                   "a granular flow as a whole",
                   {"shape", "objects", "steps"},
                   {{"rise", "greatest rise of the energy", "of the greatest kinetic energy",
                     Better::less, Format::tiny},
                    {"deepest", "deepest penetration", "edges of a body", Better::less},
                    {"pairs", "touching pairs at the end", "", Better::neither, Format::count},
                    {"points", "contact points at the end", "", Better::neither, Format::count},
                    {"fingerprint", "all bodies' bits", "", Better::neither, Format::text}}});
  results.declare({"flow",
                   "pipeline",
                   "steps of the granular flow",
                   {"shape", "objects", "step"},
                   {{"seconds", "time", "s"},
                    {"kinetic", "kinetic", "energy"},
                    {"potential", "potential", "energy"},
                    {"elastic", "in contacts", "energy"},
                    {"balance", "all, without what refilling adds", "energy"},
                    {"deepest", "deepest penetration", "edges of a body"},
                    {"pairs", "touching pairs", "", Better::neither, Format::count},
                    {"points", "contact points", "", Better::neither, Format::count}}});
}

std::vector<ReportStep> plan_flows(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  for (const auto& [name, shape] : kFlowShapes) {
    FlowCell cell{.options = options, .shape_name = name, .shape = shape};
    if (options.quick) {
      cell.objects = 60;
      cell.steps = 200;
    }
    const double bodies = static_cast<double>(cell.objects) * static_cast<double>(cell.steps);
    steps.push_back({"granular flow of " + cell.shape_name, 1.5e-6 * bodies,
                     [cell](Results& results) { cell.measure(results); }});
  }
  return steps;
}

void show_flows(const Results& results, ReportPage& page) {
  show_phases(results, page);
  const auto rows = results.rows("flow");
  if (!rows.empty()) {
    page.heading("Energy and penetration over time");
    page.paragraph(
        "Friction and dampers take energy away, and gravity only turns one kind into another: the "
        "total, without what is added where bodies that left the funnel are put back above it, "
        "must never rise. Penetration shows how soft the contacts are; a sudden peak would be a "
        "contact that was found too late.");
    std::vector<Plot> plots;
    for (const Json& shape : distinct(rows, "shape")) {
      Plot plot{.id = "flow_energy_" + key_text(shape),
                .title = "energy, " + key_text(shape),
                .x = {"simulated time, s", false},
                .y = {"energy (density 1, edges about 1, gravity 10)", false}};
      plot.series = flow_lines(results, shape, {"kinetic", "potential", "elastic", "balance"});
      plots.push_back(std::move(plot));
    }
    for (const auto& [value, label] :
         {std::pair{"deepest", "deepest penetration, edges of a body"},
          std::pair{"pairs", "touching pairs"}, std::pair{"elastic", "energy in contacts"}}) {
      Plot plot{.id = std::string("flow_") + value,
                .title = label,
                .x = {"simulated time, s", false},
                .y = {label, false}};
      plot.series =
          series_of(results, {"flow", Json::object(), "shape", "seconds", value}, false, false);
      plots.push_back(std::move(plot));
    }
    page.add(plots);
    page.command((*rows.front())["command"]);
    for (const char* value : {"rise", "deepest"}) {
      page.add(pivot(results, {"flows", Json::object(), "shape", "steps", value}));
    }
  }
}

}  // namespace winnow::bench
