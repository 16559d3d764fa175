#include "engine/arena.h"
#include "engine/counting_resource.h"
#include "goals/kinds.h"
#include "simulation/flow_check.h"
#include "simulation/flow_history.h"
#include "simulation/flow_phases.h"
#include "tool/table.h"

#include <algorithm>

namespace winnow::bench {
namespace {

/// Rises of the energy that are taken for errors of the integration.
constexpr double kMostEnergyRise = 1e-3;

std::string found(const SceneTiming& timing) {
  return timing.engine + " " + short_number(timing.median_ms()) + " ms, " +
         grouped(timing.finds.touching) + " touching, " + grouped(timing.finds.points) + " points";
}

std::string scene_name(const Ask& ask) {
  return ask.text("scene") + (ask.get<bool>("resting") ? ", at rest" : ", moving a little");
}

/// A flow whose memory is counted.
struct CountedFlow {
  explicit CountedFlow(FlowOptions options) : flow(with(options)) {}

  FlowOptions with(FlowOptions options) {
    options.memory = &memory;
    return options;
  }

  CountingResource memory;
  GranularFlow flow;
};

FlowOptions flow_options(const Ask& ask, Execution execution) {
  FlowOptions options;
  options.objects = ask.count("objects");
  options.shape = ask.text("shape") == "spheres" ? FlowShape::spheres : FlowShape::mixed;
  options.execution = execution;
  return options;
}

std::string shares(const FlowTimes& times) {
  const double all = times.total();
  const auto share = [&](double ms) { return short_number(100.0 * ms / all) + " %"; };
  return "broad " + share(times.broad + times.move) + ", mid " + share(times.mid) + ", narrow " +
         share(times.narrow) + ", solver " + share(times.solver);
}

}  // namespace

std::vector<Goal> pipeline_scene(const Ask& ask, const std::vector<Ask>&, Lab& lab) {
  const PipelineMeasurement& measured = lab.pipeline(ask.text("scene"), ask.get<bool>("resting"));
  const double scale = measured.machine_ms / Lab::kReferenceMachineMs;
  std::vector<Goal> goals;
  const auto asked = ask.get<std::vector<double>>("asked_ms");
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const int threads = static_cast<int>(i) + 1;
    const SceneTiming* own = measured.winnow(threads);
    goals.push_back({.what = scene_name(ask) + ", " + std::to_string(threads) +
                             (threads == 1 ? " thread" : " threads"),
                     .unit = "ms",
                     .asked = asked[i] * scale,
                     .measured = own->median_ms(),
                     .detail = found(*own) + "; asked " + short_number(asked[i]) + " ms, scaled"});
  }
  const SceneTiming* own = measured.winnow(1);
  for (const auto& [name, ratio] : ask.get<std::map<std::string, double>>("times_faster")) {
    const SceneTiming* peer = measured.peer(name);
    if (peer == nullptr) continue;
    goals.push_back({.what = scene_name(ask) + ", against " + name,
                     .unit = "times faster",
                     .sense = Goal::Sense::at_least,
                     .asked = ratio,
                     .measured = peer->median_ms() / own->median_ms(),
                     .detail = found(*own) + "; " + found(*peer)});
  }
  return goals;
}

std::vector<Goal> pipeline_tori(const Ask& ask, const std::vector<Ask>&, Lab& lab) {
  const MeshMeasurement& measured = lab.meshes();
  const MeshTiming& own = measured.timings.front();
  const MeshTiming* peer = measured.peer();
  const double scale = measured.machine_ms / Lab::kReferenceMachineMs;
  const auto existing = ask.get<std::vector<double>>("existing_ms");
  std::vector<Goal> goals;
  for (std::size_t p = 0; p < existing.size(); ++p) {
    const std::string what = "tori, about " + grouped(torus_poses()[p].about) + " triangle pairs";
    double best = existing[p] * scale;
    std::string detail = "FCL elsewhere " + short_number(best) + " ms";
    if (peer != nullptr) {
      best = median_of(peer->collide_ms[p]);
      detail = peer->engine + " here " + short_number(best) + " ms, " + grouped(peer->pairs[p]) +
               " pairs; winnow " + grouped(own.pairs[p]);
      goals.push_back({.what = what + ", found by one alone",
                       .unit = "pairs",
                       .asked = 0.0,
                       .measured = static_cast<double>(peer->differ[p])});
    }
    goals.push_back({.what = what,
                     .unit = "ms",
                     .asked = best / ask.number("times_faster"),
                     .measured = median_of(own.collide_ms[p]),
                     .detail = detail});
  }
  return goals;
}

std::vector<Goal> mesh_build(const Ask& ask, const std::vector<Ask>&, Lab& lab) {
  const MeshMeasurement& measured = lab.meshes();
  const MeshTiming& own = measured.timings.front();
  const MeshTiming* peer = measured.peer();
  const double scale = measured.machine_ms / Lab::kReferenceMachineMs;
  const double best =
      peer == nullptr ? ask.number("existing_ms") * scale : median_of(peer->build_ms);
  return {{.what = "build of a mesh of 20,000 triangles",
           .unit = "ms",
           .asked = best / ask.number("times_faster"),
           .measured = median_of(own.build_ms),
           .detail = (peer == nullptr ? "FCL elsewhere " : peer->engine + " here ") +
                     short_number(best) + " ms"},
          {.what = "mesh with its tree",
           .unit = "bytes/triangle",
           .asked = ask.number("bytes_per_triangle"),
           .measured = own.bytes_per_triangle,
           .detail =
               peer == nullptr ? "" : peer->engine + " " + short_number(peer->bytes_per_triangle)}};
}

std::vector<Goal> flow_phases(const Ask& ask, const std::vector<Ask>&, Lab&) {
  GranularFlow flow(flow_options(ask, Execution::serial()));
  flow.keep_contact_poses();
  for (std::size_t i = 0; i < ask.count("steps"); ++i) flow.step();
  FlowPhases phases(flow, Execution::serial());
  std::vector<double> frame;
  std::vector<double> alone;
  FlowTimes profile;
  for (std::size_t i = 0; i < ask.count("rounds"); ++i) {
    flow.step();
    const FlowTimes& whole = flow.times();
    frame.push_back(whole.move + whole.narrow);
    alone.push_back(phases.run().total());
    flow.step(true);
    profile = flow.times();
  }
  return {{.what = "frame of " + grouped(flow.objects()) + " " + ask.text("shape") +
                   " over the sum of the phases' own benchmarks",
           .unit = "times",
           .asked = ask.number("asked"),
           .measured = median_of(frame) / median_of(alone),
           .detail = short_number(median_of(frame)) + " over " + short_number(median_of(alone)) +
                     " ms, " + grouped(flow.contacts().size()) +
                     " pairs; shares: " + shares(profile)}};
}

std::vector<Goal> flow_soak(const Ask& ask, const std::vector<Ask>&, Lab&) {
  CountedFlow counted(flow_options(ask, Execution::parallel()));
  GranularFlow& flow = counted.flow;
  flow.keep_contact_poses();
  FlowHistory history;
  FlowFaults faults;
  SteadyAllocations steady;
  std::size_t before = 0;
  std::size_t warm = 0;
  for (std::size_t i = 0; i < ask.count("steps"); ++i) {
    if (i == ask.count("warm_up")) {
      before = counted.memory.allocations();
      warm = steady.count();
    }
    flow.step();
    history.add(flow);
    steady.note(flow, counted.memory.allocations());
    if (i % ask.count("check") == 0) faults += check_contacts(flow);
  }
  const std::string what =
      grouped(flow.steps()) + " steps of " + grouped(flow.objects()) + " bodies: ";
  return {{.what = what + "allocations after warm-up",
           .unit = "allocations",
           .asked = 0.0,
           .measured = static_cast<double>(steady.count() - warm),
           .detail = "the first " + grouped(ask.count("warm_up")) + " steps warm up; " +
                     grouped(counted.memory.allocations() - before) +
                     " with those of steps that have more contacts than any before"},
          {.what = what + "energy that contacts created",
           .unit = "of the kinetic",
           .asked = kMostEnergyRise,
           .measured = history.greatest_rise(),
           .detail = "greatest penetration " + short_number(history.deepest())},
          {.what = what + "contacts lost, invented or doubled",
           .unit = "contacts",
           .asked = 0.0,
           .measured = static_cast<double>(faults.total()),
           .detail = "of " + grouped(faults.compared) + " by brute force"}};
}

}  // namespace winnow::bench
