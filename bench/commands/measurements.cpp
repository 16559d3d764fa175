// Commands that only measure: each fills tables by functions of bench/rows, prints them and writes
// them as JSON. `add_measurements` at the end lists them; commands/main.cpp calls it.

#include "bench/commands/options.h"
#include "bench/commands/rows_command.h"
#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/measure/resident_set.h"
#include "bench/rows/cold_rows.h"
#include "bench/rows/frame_rows.h"
#include "bench/rows/host_rows.h"
#include "bench/rows/machine.h"
#include "bench/rows/memory_rows.h"
#include "bench/rows/scene_rows.h"
#include "bench/scenes/scene.h"

#include <memory>

namespace winnow::bench {
namespace {

/// Base of commands that measure partitions on several scenes, sizes and numbers of threads.
class ScenesCommand : public RowsCommand {
 public:
  void add_options(CLI::App& app) {
    add_scene_options(app);
    add_threads_option(app, threads_, "Numbers of threads");
  }

 protected:
  /// Adds all options but `--threads`.
  void add_scene_options(CLI::App& app) {
    option(app, "--scene", scenes_,
           "Scenes, or files of recordings (.aabbs or .winnow, also compressed as .xz), which have "
           "a fixed number of objects");
    add_objects_option(app, objects_, "Numbers of objects");
    add_partitions_option(app, partitions_);
    add_seed_option(app, seed_);
    add_rows_options(app);
  }

  ScenesCommand(std::vector<std::string> scenes, std::vector<int> threads)
      : scenes_(std::move(scenes)), threads_(std::move(threads)) {}

  /// Adds the steps of one scene and size; the titles of the steps start with `what`.
  virtual void measure_scene(const std::string& what, const NamedScene& scene,
                             std::size_t objects) = 0;

  void measure_all() {
    const std::vector<NamedScene> scenes = named_scenes(scenes_);
    plan(objects_.size() * scenes.size() * threads_.size());
    for (const NamedScene& scene : scenes) {
      for (const std::size_t requested : objects_) {
        if (scene.is_recording() && requested != objects_.front()) continue;
        const std::size_t objects = scene.objects(requested);
        measure_scene(scene.name + ", " + grouped(objects) + " objects", scene, objects);
      }
    }
  }

  std::vector<std::string> scenes_;
  std::vector<std::size_t> objects_{10'000, 100'000};
  std::vector<int> threads_;
  std::vector<std::string> partitions_{"all"};
  std::uint64_t seed_ = 1;
};

class Throughput final : public ScenesCommand {
 public:
  Throughput() : ScenesCommand(main_scenes(), usual_threads()) {}

  void add_options(CLI::App& app) {
    ScenesCommand::add_options(app);
    app.add_flag("--peers", peers_,
                 "Also measure other libraries, and the yardstick if it was built");
    app.add_flag("--yardstick", yardstick_, "Also measure the yardstick");
    add_frames_option(app, frames_);
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
    declare_frames(results);
    measure_all();
    print("throughput", {"frame_ms", "update_ms", "worst_ms", "first_ms", "pairs", "pairs_per_s",
                         "bytes_per_object", "core_distance_ns", "frames", "fingerprint"});
    for (const char* table : {"throughput_threads", "throughput_growth", "throughput_skipped"}) {
      print(table);
    }
  }
  void measure_scene(const std::string& what, const NamedScene& scene,
                     std::size_t objects) override {
    for (const int threads : threads_) {
      step(what + ", " + threads_text(threads), [&] {
        add_frame_race(results, scene,
                       {.objects = objects,
                        .seed = seed_,
                        .partitions = partitions_,
                        .threads = {threads},
                        .peers = peers_,
                        .yardstick = peers_ || yardstick_,
                        .frames = frames_});
      });
    }
    derive_frames(results, scene.name, objects);
  }

  bool peers_ = false;
  bool yardstick_ = false;
  std::size_t frames_ = 0;
};

class FootprintCommand final : public ScenesCommand {
 public:
  FootprintCommand() : ScenesCommand({"uniform"}, {usual_threads().back()}) {}

 private:
  void measure() override {
    declare_memory(results);
    keep_resident_set_exact();
    measure_all();
    print("memory", {"bounds", "keys", "client_data", "structure", "scratch", "results", "reserved",
                     "used", "pair_buffer", "exact", "peak_first", "peak_later"});
    print("memory_ratio");
  }
  void measure_scene(const std::string& what, const NamedScene& scene,
                     std::size_t objects) override {
    const std::vector<std::string> partitions = partitions_for(partitions_, objects).taken;
    for (const int threads : threads_) {
      step(what, [&] { add_footprints(results, scene, objects, seed_, partitions, threads); });
    }
  }
};

class Cold final : public ScenesCommand {
 public:
  Cold() : ScenesCommand(kColdScenes, usual_threads()) { objects_ = {1000, 10'000, 100'000}; }

  void add_options(CLI::App& app) {
    ScenesCommand::add_options(app);
    number(app, "--rounds", rounds_, 1, 1000, "Number of new partitions of each kind");
  }

 private:
  void measure() override {
    declare_cold(results);
    measure_all();
    print("cold", {"insert_ms", "build_ms", "pairs_ms", "total_ms", "reserved_ms", "ready_ms",
                   "reserve_ms", "over_yardstick"});
  }
  void measure_scene(const std::string& what, const NamedScene& scene,
                     std::size_t objects) override {
    const std::vector<std::string> partitions = partitions_for(partitions_, objects).taken;
    for (const int threads : threads_) {
      step(what + ", " + threads_text(threads),
           [&] { add_cold(results, scene, objects, seed_, partitions, threads, rounds_); });
    }
  }

  std::size_t rounds_ = 7;
};

class HostsCommand final : public ScenesCommand {
 public:
  HostsCommand() : ScenesCommand({"uniform", "mixed"}, {2}) {
    partitions_ = {"LinearBvh", "SweepAndPrune", "HierarchicalGrid"};
  }

  void add_options(CLI::App& app) {
    ScenesCommand::add_options(app);
    number(app, "--frames", frames_, 1, 1e6, "Number of timed frames");
  }

 private:
  void measure() override {
    declare_hosts(results);
    measure_all();
    print("hosts");
  }
  void measure_scene(const std::string& what, const NamedScene& scene,
                     std::size_t objects) override {
    const std::vector<std::string> partitions = partitions_for(partitions_, objects).taken;
    for (const int threads : threads_) {
      step(what + ", " + threads_text(threads),
           [&] { add_hosts(results, scene, objects, seed_, partitions, threads, frames_); });
    }
  }

  std::size_t frames_ = 101;
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
    declare_scenes(results, true);
    for (const std::string& scene : scenes_) {
      if (costs_) {
        step(scene, [&] { measure_costs(scene); });
      } else {
        measure_scene(scene);
      }
    }
    for (const char* table : {"whole_scenes", "scene_ratios", "scene_levels", "scene_costs"}) {
      print(table);
    }
  }

  void measure_costs(const std::string& scene) {
    add_scene_costs(results, {.scene = scene,
                              .threads = options_.threads.front(),
                              .frames = options_.frames,
                              .bodies = options_.bodies,
                              .seed = options_.seed});
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
  PipelineMeasureOptions options_{.machine_clock = false};
};

}  // namespace

std::vector<Command> add_measurements(CLI::App& app) {
  return {
      command<Throughput>(app, "throughput",
                          "Measures partitions and other libraries, which take turns: time and "
                          "memory of a frame, growth with the number of objects, and speedup by "
                          "threads. All must find the same pairs."),
      command<Cold>(app, "cold",
                    "Measures first frames of new partitions, on memory that was written before "
                    "and on memory that was not: insertion, build, all pairs, and the yardstick's "
                    "frame for comparison."),
      command<HostsCommand>(app, "hosts",
                            "Measures frames of partitions whose tasks run on a simple thread pool "
                            "(a JobSystem) and on oneTBB, in turns."),
      command<FootprintCommand>(app, "footprint",
                                "Measures bytes per object by purpose, and checks them against the "
                                "allocated memory and the resident set of the process."),
      command<Pipeline>(app, "pipeline",
                        "Measures the time from poses to contacts in whole scenes, for winnow and "
                        "other libraries in turns: a pile of 20,000 bodies and 2,000 hulls on a "
                        "terrain of 200,978 triangles, each moving slightly (without carry-over) "
                        "and at rest (with carry-over).")};
}

}  // namespace winnow::bench
