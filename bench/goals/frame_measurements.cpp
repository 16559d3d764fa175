#include "bench/contenders/partitions.h"
#include "bench/goals/choice.h"
#include "bench/goals/kernel_times.h"
#include "bench/goals/measurements.h"
#include "bench/rows/frame_rows.h"
#include "bench/rows/machine.h"

#include <algorithm>
#include <stdexcept>

namespace winnow::bench {
namespace {

MeasureOptions goal_race(std::size_t objects) {
  return {.objects = objects, .frames = objects <= 20'000 ? 81U : objects <= 300'000 ? 26U : 8U};
}

NamedScene scene_of(const Json& options) {
  return named_scenes({options.at("scene")}).front();
}

Json as_rows_of(const std::string& scene, std::size_t objects) {
  return {{"frames", {{"scene", scene}, {"objects", objects}}}};
}

/// The median over the frames of a's time over b's, the first frame left out.
double median_ratio(const Run& a, const Run& b) {
  std::vector<double> ratios;
  for (std::size_t f = 1; f < a.frame_ms.size(); ++f) {
    ratios.push_back(a.frame_ms[f] / b.frame_ms[f]);
  }
  return median_of(ratios);
}

/// Copies the rows of a table, which must be declared in both.
void copy_rows(const Results& from, Results& to, const std::string& table) {
  for (const Json* row : from.rows(table)) {
    Json copy = *row;
    copy.erase("id");
    to.add(table, std::move(copy));
  }
}

}  // namespace

/// Every partition that suits the size on 1 and 2 threads, interleaved.
void measure_frames(const Json& options, Lab& /*lab*/, Measured& measured) {
  declare_frames(measured.results);
  declare_choice(measured.results);
  MeasureOptions how = goal_race(options.at("objects"));
  how.threads = {1, 2};
  how.machine_clock = true;
  const NamedScene scene = scene_of(options);
  const Measurement raced = add_frame_race(measured.results, scene, how);
  measured.machine_ms = raced.machine_ms;
  add_settled_choice(measured.results, scene.name, raced);
}

/// A partition's time on one scene over its time on another, one thread: the median of rounds in
/// which both scenes take turns.
void measure_turns(const Json& options, Lab& /*lab*/, Measured& measured) {
  constexpr int kRounds = 7;
  measured.results.declare({"turns",
                            "engine",
                            "time on one scene over time on another",
                            {"partition", "objects"},
                            {{"ratio", "ratio", "times", Better::less}}});
  const std::size_t objects = options.at("objects");
  MeasureOptions part = goal_race(objects);
  part.frames = objects <= 20'000 ? 21 : 9;
  part.scene = options.at("scene");
  MeasureOptions whole = part;
  whole.scene = options.at("of");
  std::map<std::string, std::vector<double>> ratios;
  for (int round = 0; round < kRounds; ++round) {
    const Measurement a = measure(part);
    const Measurement b = measure(whole);
    for (std::size_t i = 0; i < a.partition_runs; ++i) {
      ratios[a.runs[i].engine].push_back(a.runs[i].median_ms() / b.runs[i].median_ms());
    }
  }
  for (const auto& [partition, of_rounds] : ratios) {
    measured.results.add(
        "turns", {{"partition", partition}, {"objects", objects}, {"ratio", median_of(of_rounds)}});
  }
}

/// The instruction set chosen by default against each narrower one, frame by frame, one thread.
void measure_isas(const Json& options, Lab& /*lab*/, Measured& measured) {
  measured.results.declare({"isas",
                            "engine",
                            "the active instruction set against a narrower one",
                            {"partition", "isa"},
                            {{"ratio", "ratio", "times", Better::less}}});
  MeasureOptions how = goal_race(options.at("objects"));
  how.scene = options.at("scene");
  how.isas.assign(available_isas().begin(), available_isas().end());
  const Measurement raced = measure(how);
  for (const Run& usual : raced.partitions()) {
    if (usual.isa != active_isa()) continue;
    for (const Run& other : raced.partitions()) {
      if (other.engine != usual.engine || other.isa >= usual.isa) continue;
      measured.results.add("isas", {{"partition", usual.engine},
                                    {"isa", to_string(other.isa)},
                                    {"ratio", median_ratio(usual, other)}});
    }
  }
  measured.absent = measured.results.rows("isas").empty();
}

/// What one partition holds without results, on 1 and 2 threads.
void measure_bytes(const Json& options, Lab& /*lab*/, Measured& measured) {
  declare_frames(measured.results);
  for (const NamedScene& scene : named_scenes(options.at("scenes"))) {
    add_frame_race(measured.results, scene,
                   {.objects = options.at("objects"),
                    .partitions = {options.at("partition")},
                    .threads = {1, 2},
                    .frames = 4});
  }
}

void measure_key_costs_of(const Json& options, Lab& /*lab*/, Measured& measured) {
  declare_keys(measured.results);
  for (const std::string& partition : testing_partitions()) {
    for (const std::size_t objects : options.at("objects")) {
      add_key_costs(measured.results, partition, objects, options.at("order") == "random");
    }
  }
}

/// Every partition on every instruction set and numbers of threads against the reference: of a
/// scene, or of the recordings of a folder.
void measure_same_pairs(const Json& options, Lab& /*lab*/, Measured& measured) {
  measured.results.declare({"same_pairs",
                            "engine",
                            "runs against the reference",
                            {"scene", "objects", "partition", "threads", "isa"},
                            {{"differs", "finds other pairs", "", Better::less}}});
  std::vector<NamedScene> scenes;
  if (options.contains("folder")) {
    scenes = named_scenes(recordings_in(options["folder"]));
  } else {
    scenes.push_back(scene_of(options));
  }
  measured.absent = scenes.empty();
  for (const NamedScene& scene : scenes) {
    MeasureOptions how{.scene = scene.argument,
                       .recording = scene.recording.get(),
                       .threads = options.at("threads"),
                       .reference = true};
    how.isas.assign(available_isas().begin(), available_isas().end());
    how.objects = scene.objects(options.value("objects", std::size_t{1}));
    how.frames = scene.is_recording() ? scene.recording->frames.size() : 6;
    const Measurement raced = measure(how);
    for (const Run& run : raced.partitions()) {
      measured.results.add("same_pairs", {{"scene", scene.name},
                                          {"objects", raced.objects},
                                          {"partition", run.engine},
                                          {"threads", run.threads},
                                          {"isa", to_string(run.isa)},
                                          {"differs", run.same_pairs(raced.runs.back()) ? 0 : 1}});
    }
  }
}

void measure_limits(const Json& options, Lab& lab, Measured& measured) {
  declare_frames(measured.results);
  declare_limits(measured.results);
  const std::string scene = options.at("scene");
  const std::size_t objects = options.at("objects");
  copy_rows(lab.measured(as_rows_of(scene, objects)).results, measured.results, "throughput");
  add_limit(measured.results, scene, objects);
}

/// How the time grows with the number of objects.
void measure_growth(const Json& options, Lab& lab, Measured& measured) {
  declare_frames(measured.results);
  const std::string scene = options.at("scene");
  for (const std::size_t objects : options.at("objects")) {
    copy_rows(lab.measured(as_rows_of(scene, objects)).results, measured.results, "throughput");
    derive_frames(measured.results, scene, objects);
  }
}

void measure_kernels(const Json& options, Lab& /*lab*/, Measured& measured) {
  measured.results.declare({"kernels",
                            "engine",
                            "kernels by instruction set",
                            {"kernel", "isa"},
                            {{"ns", "time", "ns"}}});
  const auto isas = isa_names();
  const std::string wide = options.at("wide");
  measured.absent = std::find(isas.begin(), isas.end(), wide) == isas.end();
  if (measured.absent) return;
  const auto kernels = kernel_times();
  if (!kernels) throw std::runtime_error("not measured: the target winnow_micro is not built");
  for (const auto& [kernel, times] : *kernels) {
    if (!times.contains(wide) || !times.contains(options.at("narrow"))) continue;
    for (const auto& [isa, ns] : times) {
      measured.results.add("kernels", {{"kernel", kernel}, {"isa", isa}, {"ns", ns}});
    }
  }
}

}  // namespace winnow::bench
