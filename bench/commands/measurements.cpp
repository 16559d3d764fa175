// Commands that only measure: each fills tables by functions of bench/rows, prints them and writes
// them as JSON. `add_measurements` at the end lists them; commands/main.cpp calls it.

#include "bench/commands/options.h"
#include "bench/commands/rows_command.h"
#include "bench/common/table.h"
#include "bench/measure/footprint.h"
#include "bench/rows/machine.h"
#include "bench/rows/rows.h"
#include "bench/scenes/scene.h"

#include <memory>

namespace winnow::bench {
namespace {

/// A measurement of partitions by a function of bench/rows, on several scenes, sizes and numbers of
/// threads.
struct PartitionMeasurement {
  void (*prepare)() = nullptr;  ///< null: nothing
  void (*add)(Results&, const NamedScene&, const MeasureOptions&);
  std::vector<std::string> scenes;
  std::vector<int> threads;
  const char* count_option = nullptr;  ///< null: none
  const char* count_meaning = "";
  std::size_t count = 0;
  bool races_peers = false;  ///< has options for other libraries
  std::vector<std::string> tables;
  std::vector<std::string> values{};  ///< of the first table; empty: all
  std::vector<std::size_t> objects{10'000, 100'000};
  std::vector<std::string> partitions{"all"};
};

class MeasurePartitions final : public RowsCommand {
 public:
  explicit MeasurePartitions(PartitionMeasurement measurement)
      : measurement_(std::move(measurement)) {}

  void add_options(CLI::App& app) {
    option(app, "--scene", measurement_.scenes,
           "Scenes, or files of recordings (.aabbs or .winnow, also compressed as .xz), which have "
           "a fixed number of objects");
    add_objects_option(app, measurement_.objects, "Numbers of objects");
    add_partitions_option(app, measurement_.partitions);
    add_threads_option(app, measurement_.threads, "Numbers of threads");
    add_seed_option(app, seed_);
    add_rows_options(app);
    if (measurement_.count_option != nullptr) {
      number(app, measurement_.count_option, measurement_.count, 1, 1e6,
             measurement_.count_meaning);
    }
    if (!measurement_.races_peers) return;
    app.add_flag("--peers", peers_,
                 "Also measure other libraries, and the yardstick if it was built");
    app.add_flag("--yardstick", yardstick_, "Also measure the yardstick");
  }

 private:
  void measure() override {
    if (peers_ && !has_peers()) {
      throw ArgumentError(
          "--peers: this tool was built without other libraries; bench/run --with-peers installs "
          "and builds them");
    }
    if (yardstick_ && !has_yardstick()) {
      throw ArgumentError(
          "--yardstick: this tool was built without it; set the CMake variable WINNOW_YARDSTICK to "
          "the folder of the prototype");
    }
    if (measurement_.prepare != nullptr) measurement_.prepare();
    const std::vector<NamedScene> scenes = named_scenes(measurement_.scenes);
    plan(measurement_.objects.size() * scenes.size() * measurement_.threads.size());
    for (const NamedScene& scene : scenes) {
      for (const std::size_t requested : measurement_.objects) {
        if (scene.is_recording() && requested != measurement_.objects.front()) continue;
        for (const int threads : measurement_.threads) {
          measure_scene(scene, scene.objects(requested), threads);
        }
      }
    }
    print(measurement_.tables.front(), measurement_.values);
    for (std::size_t i = 1; i < measurement_.tables.size(); ++i) print(measurement_.tables[i]);
  }

  void measure_scene(const NamedScene& scene, std::size_t objects, int threads) {
    step(scene.name + ", " + grouped(objects) + " objects, " + threads_text(threads), [&] {
      measurement_.add(results, scene,
                       {.objects = objects,
                        .seed = seed_,
                        .partitions = measurement_.partitions,
                        .threads = {threads},
                        .peers = peers_,
                        .yardstick = peers_ || yardstick_ || !measurement_.races_peers,
                        .frames = measurement_.count});
    });
  }

  PartitionMeasurement measurement_;
  std::uint64_t seed_ = 1;
  bool peers_ = false;
  bool yardstick_ = false;
};

class Pipeline final : public RowsCommand {
 public:
  void add_options(CLI::App& app) {
    one_of(app, "--scene", scenes_, {"pile", "terrain", "balls"}, "Scenes");
    one_of(app, "--level", levels_, scene_level_names(), "Contact levels for winnow");
    app.add_flag("--costs", costs_,
                 "Instead measure the memory of winnow's contacts and the cost of a margin, on the "
                 "first of the given numbers of threads");
    add_threads_option(app, options_.threads, "Numbers of threads for winnow");
    number(app, "--frames", options_.frames, 1, 10'000, "Number of timed frames");
    number(app, "--bodies", options_.bodies, 1, 1e6,
           "Number of bodies in pile, terrain and balls (default: the usual one)");
    app.add_flag("!--no-peers", options_.peers, "Do not measure other libraries");
    add_seed_option(app, options_.seed);
    add_rows_options(app);
  }

 private:
  void measure() override {
    plan(2 * scenes_.size() * levels_.size());
    for (const std::string& scene : scenes_) {
      if (costs_) {
        options_.scene = scene;
        step(scene, [&] { add_scene_costs(results, options_); });
      } else {
        measure_scene(scene);
      }
    }
    for (const char* table : {"whole_scenes", "scene_ratios", "scene_levels", "scene_costs"}) {
      print(table);
    }
  }

  /// All engines are measured at level manifold; at lower levels only winnow.
  void measure_scene(const std::string& scene) {
    const std::unique_ptr<BodySet> set = make_pipeline_scene(scene, options_.bodies, options_.seed);
    options_.scene = scene;
    options_.set = set.get();
    for (const bool resting : {false, true}) {
      options_.resting = resting;
      for (const std::string& level : levels_) {
        step(scene + (resting ? ", at rest" : ", moving a little"), [&] {
          if (level == "manifold") {
            add_scene_race(results, options_);
          } else {
            add_scene_level(results, options_, level);
          }
        });
      }
    }
  }

  std::vector<std::string> scenes_{"pile", "terrain"};
  std::vector<std::string> levels_{"manifold"};
  bool costs_ = false;
  PipelineMeasureOptions options_;
};

}  // namespace

void add_measurements(CLI::App& app) {
  const auto add = [&](const char* name, const char* what, const char* details,
                       PartitionMeasurement measurement) {
    command<MeasurePartitions>(app, name, what, details, std::move(measurement));
  };
  add("throughput",
      "Measures partitions and other libraries, which take turns: time and memory of a frame",
      "Also measures growth with the number of objects, and speedup by threads. All must find the "
      "same pairs.",
      {.add = add_throughput,
       .scenes = main_scenes(),
       .threads = usual_threads(),
       .count_option = "--frames",
       .count_meaning = "Number of frames, including the first one",
       .races_peers = true,
       .tables = {"throughput", "throughput_threads", "throughput_growth", "throughput_skipped"},
       .values = {"frame_ms", "update_ms", "worst_ms", "first_ms", "pairs", "pairs_per_s",
                  "bytes_per_object", "core_distance_ns", "frames", "fingerprint"}});
  add("cold",
      "Measures first frames of new partitions: insertion, build, all pairs, and the yardstick",
      "Memory was written before, or not.",
      {.add = add_cold,
       .scenes = kColdScenes,
       .threads = usual_threads(),
       .count_option = "--rounds",
       .count_meaning = "Number of new partitions of each kind",
       .tables = {"cold"},
       .values = {"insert_ms", "build_ms", "pairs_ms", "total_ms", "reserved_ms", "ready_ms",
                  "reserve_ms", "over_yardstick"},
       .objects = {1000, 10'000, 100'000}});
  add("hosts",
      "Measures partitions whose tasks run on a thread pool (a JobSystem) and on oneTBB, in turns",
      "",
      {.add = add_hosts,
       .scenes = {"uniform", "mixed"},
       .threads = {2},
       .count_option = "--frames",
       .count_meaning = "Number of timed frames",
       .tables = {"hosts"},
       .partitions = {"LinearBvh", "SweepAndPrune", "HierarchicalGrid"}});
  add("footprint", "Measures bytes per object by purpose",
      "The bytes are checked against the allocated memory and the resident set of the process.",
      {.prepare = keep_resident_set_exact,
       .add = add_footprints,
       .scenes = {"uniform"},
       .threads = {usual_threads().back()},
       .tables = {"memory", "memory_ratio"},
       .values = {"bounds", "keys", "client_data", "structure", "scratch", "results", "reserved",
                  "used", "pair_buffer", "exact", "peak_first", "peak_later"}});
  command<Pipeline>(app, "pipeline", "Measures the time from poses to contacts in whole scenes",
                    "Winnow and other libraries take turns: a pile of 20,000 bodies and 2,000 "
                    "hulls on a terrain of 200,978 triangles, each moving slightly (without "
                    "carry-over) and at rest (with carry-over).");
}

}  // namespace winnow::bench
