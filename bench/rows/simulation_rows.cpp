// Rows about simulations: granular flow (the time of each phase, a summary, samples over time),
// structures that must stand, and barriers that nothing may pass. bench/simulation runs them.

#include "bench/rows/rows.h"

#include <winnow/pipeline/narrow_phase.h>
#include "bench/common/need.h"
#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/measure/fingerprint.h"
#include "bench/simulation/barriers.h"
#include "bench/simulation/standing.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace winnow::bench {
namespace {

constexpr std::pair<const char*, FlowShape> kFlowShapes[] = {
    {"spheres", FlowShape::spheres}, {"mixed", FlowShape::mixed}, {"boxes", FlowShape::boxes}};
/// Number of steps of a flow that get a row.
constexpr std::size_t kFlowRows = 200;

/// Simulated seconds before the drift is measured: until then the contact springs are compressed
/// by the weight.
constexpr double kSettling = 1.0;
/// A stable structure with edges of about 1 drifts by less than this after it has settled.
constexpr double kStandingDrift = 0.02;

Json with_keys(const FlowRowOptions& row_options, Json row) {
  row["shape"] = row_options.shape;
  row["objects"] = row_options.objects;
  row["command"] = command_text("simulate --shape ", row_options.shape, " --objects ",
                                row_options.objects, " --steps ", row_options.steps, " --seed ",
                                row_options.seed, settings_text(row_options.threads));
  return row;
}

/// Adds the times of the second half of the flow, when bodies touch each other.
void add_phases(Results& results, const FlowRowOptions& row_options, const FlowHistory& history) {
  const auto ms_of = [&](const FlowPhase& phase) {
    return history.phase_ms(phase.ms, row_options.steps / 2);
  };
  double sum = 0.0;
  for (const FlowPhase& phase : kFlowPhases) sum += median_of(ms_of(phase));
  for (const FlowPhase& phase : kFlowPhases) {
    const std::vector<double> ms = ms_of(phase);
    results.add("phases", with_keys(row_options, {{"phase", phase.name},
                                                  {"ms", to_value(ms)},
                                                  {"share", median_of(ms) / sum}}));
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

std::vector<std::string> flow_shape_names() {
  std::vector<std::string> names;
  for (const auto& [name, shape] : kFlowShapes) names.emplace_back(name);
  return names;
}

FlowOptions flow_options(const FlowRowOptions& row_options) {
  FlowOptions options;
  options.objects = row_options.objects;
  for (const auto& [name, shape] : kFlowShapes) {
    if (row_options.shape == name) options.shape = shape;
  }
  options.seed = row_options.seed;
  options.execution = execution_for(row_options.threads);
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

void add_flow_frames(Results& results, const FlowRowOptions& row_options, std::size_t frames) {
  GranularFlow flow(flow_options(row_options));
  flow.keep_contact_poses();
  for (std::size_t i = 0; i < row_options.steps; ++i) flow.step();
  std::vector<ShapeId> shapes;
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < flow.objects(); ++i) {
    shapes.push_back(flow.shape(i));
    boxes.push_back(flow.box(i));
  }
  const Execution execution = execution_for(row_options.threads);
  Partition partition = make_named("LinearBvh", {.execution = execution});
  std::vector<Key> keys(boxes.size());
  need(partition.insert(boxes, {}, keys), "boxes");
  PairBuffer found;
  std::vector<BodyPair> pairs;
  NarrowPhase narrow;
  NarrowResult contacts;
  std::vector<double> frame_ms;
  std::vector<double> phases_ms;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    flow.step();
    frame_ms.push_back(flow.last().times.move + flow.last().times.narrow);
    const std::vector<Pose> poses(flow.contact_poses().begin(),
                                  flow.contact_poses().end() - 1);  // without the mesh
    const Stopwatch clock;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      boxes[i] = flow.shapes().bounds(shapes[i], poses[i]);
    }
    need(partition.update(keys, boxes), "boxes");
    need(partition.self_pairs(found), "pairs");
    pairs.clear();
    for (const Pair& pair : found) pairs.push_back({pair.first, pair.second});
    need(narrow.collide(flow.shapes(), {shapes, poses}, pairs, {.execution = execution}, contacts),
         "contacts");
    phases_ms.push_back(clock.ms());
  }
  results.add("flow_frames", {{"shape", row_options.shape},
                              {"objects", row_options.objects},
                              {"how", "frame"},
                              {"ms", to_value(frame_ms)}});
  results.add("flow_frames", {{"shape", row_options.shape},
                              {"objects", row_options.objects},
                              {"how", "phases"},
                              {"ms", to_value(phases_ms)}});
}

void add_standing(Results& results, const StandingRowOptions& row_options) {
  StandingOptions options;
  options.part_manifolds = !row_options.reduced;
  options.execution = execution_for(row_options.threads);
  Standing standing(row_options.structure, options);
  while (standing.time() < std::min(kSettling, row_options.seconds)) standing.step();
  const double settled = standing.drift();
  standing.mark();
  double kept = 1.0;
  while (standing.time() < row_options.seconds) {
    standing.step();
    kept = std::min(kept, standing.kept_points());
  }
  results.add("standing",
              {{"structure", row_options.structure},
               {"manifolds", row_options.reduced ? "one a region" : "of all parts"},
               {"seconds", row_options.seconds},
               {"bodies", standing.bodies()},
               {"points", standing.contacts().points()},
               {"settled", settled},
               {"drift", standing.drift()},
               {"tilt", standing.tilt()},
               {"deepest", standing.deepest()},
               {"kept", kept},
               {"islands", standing.islands()},
               {"colours", standing.colours()},
               {"fingerprint", to_hex(standing.fingerprint())},
               {"command", command_text("simulate --standing ", row_options.structure,
                                        " --seconds ", short_number(row_options.seconds),
                                        settings_text(row_options.threads))}});
  if (!(standing.drift() < kStandingDrift)) {
    throw std::runtime_error(row_options.structure + " does not stand");
  }
}

std::vector<std::string> barrier_names() {
  return {"funnel", "blade", "cloth"};
}

void add_barrier(Results& results, const BarrierRowOptions& row_options) {
  const auto barrier = make_barrier({.scene = row_options.scene,
                                     .size = row_options.size,
                                     .execution = execution_for(row_options.threads)});
  std::vector<double> ms;
  for (std::size_t i = 0; i < row_options.steps; ++i) {
    const Stopwatch clock;
    barrier->step();
    ms.push_back(clock.ms());
  }
  const BarrierFigures figures = barrier->figures();
  results.add("barriers",
              {{"scene", row_options.scene},
               {"objects", figures.objects},
               {"steps", figures.steps},
               {"fastest", figures.fastest},
               {"stretch", figures.strain},
               {"impacts", figures.impacts},
               {"passed", figures.passed},
               {"cut_short", figures.cut_short},
               {"ms", to_value(ms)},
               {"fingerprint", to_hex(figures.fingerprint)},
               {"command", command_text("simulate --barrier ", row_options.scene, " --steps ",
                                        row_options.steps, settings_text(row_options.threads),
                                        row_options.size != 0
                                            ? " --objects " + std::to_string(row_options.size)
                                            : "")}});
  if (figures.passed != 0) {
    throw std::runtime_error(row_options.scene + ": something passed through");
  }
}

}  // namespace winnow::bench
