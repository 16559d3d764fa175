// Rows about granular flow: the time of each phase, one summary row for a flow, and samples over
// time. bench/commands, bench/goals and bench/report call these functions; bench/simulation runs
// the flow.

#include "bench/rows/flow_rows.h"

#include <winnow/simd/isa.h>
#include "bench/measure/fingerprint.h"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

namespace winnow::bench {
namespace {

constexpr std::pair<const char*, FlowShape> kFlowShapes[] = {
    {"spheres", FlowShape::spheres}, {"mixed", FlowShape::mixed}, {"boxes", FlowShape::boxes}};
/// Number of steps of a flow that get a row.
constexpr std::size_t kFlowRows = 200;

Json with_keys(const FlowRowOptions& row_options, Json row) {
  row["shape"] = row_options.shape;
  row["objects"] = row_options.objects;
  row["command"] = "bench/run simulate --shape " + row_options.shape + " --objects " +
                   std::to_string(row_options.objects) + " --steps " +
                   std::to_string(row_options.steps) + " --threads " +
                   std::to_string(row_options.threads) + " --seed " +
                   std::to_string(row_options.seed) + " --isa " + isa_name();
  return row;
}

/// Adds the times of the second half of the flow, when bodies touch each other.
void add_phases(Results& results, const FlowRowOptions& row_options, const FlowHistory& history) {
  std::vector<Json> added;
  double sum = 0.0;
  for (const FlowPhase& phase : kFlowPhases) {
    Json row = with_keys(row_options,
                         {{"phase", phase.name},
                          {"ms", to_value(history.phase_ms(phase.ms, row_options.steps / 2))}});
    sum += value_of(row, "ms");
    added.push_back(std::move(row));
  }
  for (Json& row : added) {
    row["share"] = value_of(row, "ms") / sum;
    results.add("phases", std::move(row));
  }
}

void add_samples(Results& results, const FlowRowOptions& row_options, const FlowHistory& history) {
  const std::vector<FlowSample>& samples = history.samples();
  const std::size_t every = std::max<std::size_t>(1, samples.size() / kFlowRows);
  for (std::size_t i = 0; i < samples.size(); i += every) {
    const FlowSample& sample = samples[i];
    results.add("flow", with_keys(row_options, {{"step", i + 1},
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

}  // namespace

FlowOptions flow_options(const FlowRowOptions& row_options) {
  FlowOptions options;
  options.objects = row_options.objects;
  options.shape = flow_shape_named(row_options.shape);
  options.seed = row_options.seed;
  options.execution = row_options.threads == 1 ? Execution::serial() : Execution::parallel();
  return options;
}

void add_flow(Results& results, const FlowRowOptions& row_options, const FlowRun& run) {
  const FlowHistory& history = run.history();
  add_phases(results, row_options, history);
  add_samples(results, row_options, history);
  const FlowSample& last = history.samples().back();
  results.add("flows", with_keys(row_options, {{"steps", run.flow().steps()},
                                               {"rise", history.greatest_rise()},
                                               {"deepest", history.deepest()},
                                               {"pairs", last.contacts},
                                               {"points", last.points},
                                               {"fingerprint", to_hex(run.flow().fingerprint())}}));
  results.add("flow_checks", {{"shape", row_options.shape},
                              {"objects", row_options.objects},
                              {"steps", run.flow().steps()},
                              {"allocations", run.allocations()},
                              {"steady_allocations", run.steady_allocations()},
                              {"lost", run.faults().lost},
                              {"invented", run.faults().invented},
                              {"doubled", run.faults().doubled}});
}

void add_flow(Results& results, const FlowRowOptions& row_options) {
  FlowRun run(flow_options(row_options), row_options.steps, row_options.check);
  for (std::size_t i = 0; i < row_options.steps; ++i) run.step();
  add_flow(results, row_options, run);
}

std::vector<std::string> flow_shape_names() {
  std::vector<std::string> names;
  for (const auto& [name, shape] : kFlowShapes) names.emplace_back(name);
  return names;
}

FlowShape flow_shape_named(const std::string& name) {
  for (const auto& [shape_name, shape] : kFlowShapes) {
    if (name == shape_name) return shape;
  }
  throw std::invalid_argument("no shape " + name);
}

}  // namespace winnow::bench
