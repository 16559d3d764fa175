// Commands that only measure: each fills tables by functions of bench/rows, prints them and writes
// them as JSON. `add_measurements` at the end lists them; commands/main.cpp calls it.

#include "bench/commands/options.h"
#include "bench/commands/rows_command.h"
#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/measure/resident_set.h"
#include "bench/rows/accuracy_rows.h"
#include "bench/rows/cold_rows.h"
#include "bench/rows/filter_rows.h"
#include "bench/rows/frame_rows.h"
#include "bench/rows/host_rows.h"
#include "bench/rows/kernel_rows.h"
#include "bench/rows/machine.h"
#include "bench/rows/memory_rows.h"
#include "bench/rows/motion_rows.h"
#include "bench/rows/query_rows.h"
#include "bench/rows/scene_rows.h"
#include "bench/rows/volume_rows.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <memory>
#include <span>

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

/// A built-in scene or a recording.
struct SceneOrRecording {
  std::string scene = "uniform";
  std::string recording;

  CLI::Option* add_to(CLI::App& app, const char* what) {
    CLI::Option* added = option(app, "--scene", scene, what);
    option(app, "--recording", recording, "File of a recording, instead of a scene")
        ->excludes(added);
    return added;
  }
  [[nodiscard]] NamedScene named() const {
    return named_scenes({recording.empty() ? scene : recording}).front();
  }
};

class Filters final : public ScenesCommand {
 public:
  Filters() : ScenesCommand(kFilterScenes, {1}) {}

  void add_options(CLI::App& app) {
    add_scene_options(app);
    number(app, "--rounds", rounds_, 1, 1000,
           "Number of rounds; all contenders take turns in each");
  }

 private:
  void measure() override {
    measure_all();
    print("filters");
  }
  void measure_scene(const std::string& what, const NamedScene& scene,
                     std::size_t objects) override {
    const std::vector<std::string> partitions = partitions_for(partitions_, objects).taken;
    step(what, [&] { add_filters(results, scene, objects, seed_, partitions, rounds_); });
  }

  std::size_t rounds_ = 15;
};

class Queries final : public RowsCommand {
 public:
  void add_options(CLI::App& app) {
    scene_.add_to(app, "Scene; its first frame is used")->check(CLI::IsMember(scene_names()));
    add_objects_option(app, options_.objects);
    add_partitions_option(app, options_.partitions);
    add_threads_option(app, options_.threads);
    number(app, "--rays", options_.rays, 1, 1e8,
           "Number of rays in a set; sets of slower queries are smaller");
    number(app, "--rounds", options_.rounds, 1, 1000,
           "Number of rounds; all contenders take turns in each");
    const auto names = query_set_names();
    one_of(app, "--set", options_.sets, {names.begin(), names.end()}, "Sets of queries");
    add_seed_option(app, options_.seed);
    add_rows_options(app);
  }

 private:
  void measure() override {
    const NamedScene named = scene_.named();
    plan(1);
    step(named.name + ", " + grouped(named.objects(options_.objects)) + " objects, " +
             threads_text(options_.threads),
         [&] { add_queries(results, named, options_); });
    print("queries", {"ns", "found", "questions", "wrong", "undecided"});
  }

  SceneOrRecording scene_;
  QueryMeasureOptions options_{.machine_clock = false, .peers = true};
};

class Volumes final : public RowsCommand {
 public:
  void add_options(CLI::App& app) {
    const auto names = volume_setting_names();
    const auto partitions = volume_partitions();
    settings_.assign(names.begin(), names.end());
    scene_.add_to(app, "Built-in scene for the first table");
    one_of(app, "--setting", settings_, {names.begin(), names.end()},
           "Settings: the scene, rotated cubes, rotated rods, slow rotated cubes");
    app.add_option("--step", options_.step,
                   "Distance that objects move in a frame, in mean edge lengths; default: chosen "
                   "for each setting, or as recorded")
        ->check(CLI::NonNegativeNumber);
    number(app, "--objects", options_.objects, 1, 1e6, "Number of objects");
    one_of(app, "--partition", options_.partition, {partitions.begin(), partitions.end()},
           "Partition that stores the volumes");
    number(app, "--frames", options_.frames, 1, 1000, "Number of timed frames");
    add_seed_option(app, options_.seed);
    add_rows_options(app);
  }

 private:
  void measure() override {
    options_.scene = scene_.named();
    plan(settings_.size());
    for (const std::string& setting : settings_) {
      options_.setting = setting;
      step(setting, [&] { add_volumes(results, options_); });
    }
    print("volumes", {"reported", "overlapping", "false_positives", "make_ms", "broad_ms",
                      "narrow_ms", "sum_ms", "pays_from_ns", "bytes_per_object"});
  }

  SceneOrRecording scene_;
  VolumeRowOptions options_;
  std::vector<std::string> settings_;
};

/// A selection from a list of names; "all" selects each.
class Chosen {
 public:
  explicit Chosen(std::vector<std::string> names) : names_(std::move(names)) {}

  void add_to(CLI::App& app, const char* name, std::vector<std::string> all, const char* what) {
    all.emplace_back("all");
    one_of(app, name, names_, all, what);
  }
  template <typename Each, typename Name>
  [[nodiscard]] std::vector<Each> of(std::span<const Each> all, Name&& name) const {
    std::vector<Each> taken;
    for (const Each& one : all) {
      if (std::any_of(names_.begin(), names_.end(),
                      [&](const std::string& n) { return n == "all" || n == name(one); })) {
        taken.push_back(one);
      }
    }
    return taken;
  }

 private:
  std::vector<std::string> names_;
};

/// Base of commands that measure pairs of shapes: of some kinds, at some levels, by some tiers.
class PairsCommand : public RowsCommand {
 protected:
  PairsCommand(std::span<const PairKind> all, std::vector<std::string> levels,
               std::vector<std::string> tiers)
      : all_(all), levels_(std::move(levels)), tiers_(std::move(tiers)) {}

  void add_pair_options(CLI::App& app) {
    std::vector<std::string> kinds;
    for (const PairKind& kind : all_) kinds.emplace_back(kind.name);
    kinds_.add_to(app, "--kind", kinds, "Kinds of pairs");
    levels_.add_to(app, "--level", {kLevelNames.begin(), kLevelNames.end()}, "Contact levels");
    tiers_.add_to(app, "--tier", {kTierNames.begin(), kTierNames.end()}, "Tiers");
    app.add_flag("!--no-peers", peers_, "Do not measure other libraries");
    add_seed_option(app, seed_);
    add_rows_options(app);
  }
  [[nodiscard]] std::vector<PairKind> kinds() const {
    return kinds_.of(all_, [](const PairKind& kind) { return kind.name; });
  }
  [[nodiscard]] std::vector<ContactLevel> levels() const {
    return levels_.of(std::span<const ContactLevel>(kLevels), [](auto l) { return to_text(l); });
  }
  [[nodiscard]] std::vector<NarrowTier> tiers() const {
    return tiers_.of(std::span<const NarrowTier>(kTiers), [](auto t) { return to_text(t); });
  }

  bool peers_ = true;
  std::uint64_t seed_ = 1;

 private:
  std::span<const PairKind> all_;
  Chosen kinds_{{"all"}};
  Chosen levels_;
  Chosen tiers_;
};

class Narrow final : public PairsCommand {
 public:
  Narrow() : PairsCommand(pair_kinds(), {"all"}, {"robust"}) {}

  void add_options(CLI::App& app) {
    number(app, "--pairs", pairs_, 1, 1e7,
           "Numbers of pairs; the shapes of more than 16,384 pairs are scattered in memory");
    add_threads_option(app, threads_, "Numbers of threads for winnow");
    number(app, "--rounds", race_.rounds, 1, 1000,
           "Number of rounds; all contenders take turns in each");
    app.add_flag("--one-a-call", one_a_call_,
                 "Also measure one call for each pair, which is how other libraries work");
    app.add_flag("--upright", upright_,
                 "Rotate bodies only about the vertical axis, with prisms as hulls and walls as "
                 "triangles, so that edges and faces are parallel");
    add_pair_options(app);
  }

 private:
  void measure() override {
    plan(kinds().size() * pairs_.size());
    for (const std::size_t count : pairs_) {
      for (const PairKind& kind : kinds()) {
        step(std::string(kind.name) + ", " + grouped(count) + " pairs", [&] {
          add_pair_times(results,
                         {.kind = kind,
                          .pairs = count,
                          .levels = levels(),
                          .contenders = {.tiers = tiers(),
                                         .threads = threads_,
                                         .one_a_call = one_a_call_,
                                         .peers = peers_},
                          .seed = seed_,
                          .upright = upright_,
                          .race = race_},
                         PairKeys::settings);
        });
      }
    }
    print("narrow_speed");
    print("narrow_best");
  }

  std::vector<std::size_t> pairs_{8192, 100'000};
  std::vector<int> threads_{1};
  bool one_a_call_ = false;
  bool upright_ = false;
  NarrowRaceOptions race_;
};

class AccuracyCommand final : public PairsCommand {
 public:
  AccuracyCommand() : PairsCommand(main_pair_kinds(), {"distance"}, {"all"}) {}

  void add_options(CLI::App& app) {
    option(app, "--ratio", ratios_, "Size of the second shape divided by the size of the first")
        ->check(CLI::PositiveNumber);
    number(app, "--pairs", set_.pairs, 1, 1e7, "Number of pairs of each kind and ratio");
    number(
        app, "--offset", set_.offset, 0.0, 1e12,
        "Distance by which all pairs are moved along each axis; positions are multiples of 2^-12");
    option(app, "--angle", set_.angle,
           "Rotation of the second body relative to the first, in radians")
        ->check(CLI::NonNegativeNumber);
    number(app, "--thinness", set_.thinness, 0.0, 1.0,
           "Factor by which the height of triangles is reduced");
    app.add_flag("--by-gap", by_gap_,
                 "Also list errors by |distance| divided by size, for each power of ten");
    one_of(app, "--judge", judge_, {"oracle", "reference"},
           "Source of the true values: `oracle` computes with 100 digits; `reference`, for many "
           "pairs, is winnow's tier of that name");
    add_pair_options(app);
  }

 private:
  void measure() override {
    plan(kinds().size() * ratios_.size());
    for (const PairKind& kind : kinds()) {
      for (const double ratio : ratios_) {
        AccuracyOptions options{
            .kind = kind, .set = set_, .levels = levels(), .tiers = tiers(), .peers = peers_};
        options.set.seed = seed_;
        options.set.ratio = ratio;
        if (judge_ == "reference") options.judge = TruthSource::reference;
        step(std::string(kind.name) + ", sizes 1:" + key_text(ratio),
             [&] { add_pair_errors(results, options, by_gap_, PairKeys::settings); });
      }
    }
    print("narrow_error",
          {"ns", "pairs", "wrong", "missing", "median_distance", "worst_distance", "median_depth",
           "worst_depth", "worst_degrees", "normals_off", "beyond_bound", "recomputed", "judge"});
  }

  std::vector<double> ratios_{1.0, 1e2, 1e4};
  PairSetOptions set_{.pairs = 400, .nearest = kNearestPairs};
  bool by_gap_ = false;
  std::string judge_ = "oracle";
};

class Pipeline final : public RowsCommand {
 public:
  void add_options(CLI::App& app) {
    one_of(app, "--scene", scenes_, {"pile", "terrain", "balls", "tori"}, "Scenes");
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
        step(scene, [&] { measure_costs(scene); });
      } else if (scene == "tori") {
        step(scene, [&] { add_tori(results, options_.frames, options_.peers, false); });
      } else {
        measure_scene(scene);
      }
    }
    for (const char* table :
         {"whole_scenes", "scene_ratios", "scene_levels", "scene_costs", "tori", "mesh_builds"}) {
      print(table);
    }
  }

  void measure_costs(const std::string& scene) {
    if (scene == "tori") return;
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

  std::vector<std::string> scenes_{"pile", "terrain", "tori"};
  std::vector<std::string> levels_{"manifold"};
  bool costs_ = false;
  PipelineMeasureOptions options_{.machine_clock = false};
};

/// Measures times of impact: pairs of shapes, features of meshes, or a scene.
class Impacts final : public RowsCommand {
 public:
  void add_options(CLI::App& app) {
    what_.add_to(app, "--what", {kPairs, kFeatures, kScene}, "Moving objects");
    std::vector<std::string> kinds;
    for (const PairKind& kind : pair_kinds()) kinds.emplace_back(kind.name);
    kinds_.add_to(app, "--kind", kinds, "Kinds of pairs");
    turns_.add_to(app, "--turn", {kPairTurnNames.begin(), kPairTurnNames.end()},
                  "Rotation of the bodies of a pair");
    number(app, "--pairs", pairs_, 1, 1e6, "Number of pairs of each kind");
    number(app, "--rounds", rounds_, 1, 1000,
           "Number of rounds; all contenders take turns in each");
    number(app, "--bodies", continuous_.bodies, 1, 1e6, "Number of bodies in the scene");
    number(app, "--fast", continuous_.fast, 1, 1e6, "Number of fast bodies among them");
    add_threads_option(app, continuous_.threads);
    app.add_flag("!--no-peers", peers_, "Do not measure other libraries");
    add_seed_option(app, continuous_.seed);
    add_rows_options(app);
  }

 private:
  static constexpr const char* kPairs = "pairs";
  static constexpr const char* kFeatures = "features";
  static constexpr const char* kScene = "scene";

  void measure() override {
    const auto text = [](const char* name) { return name; };
    constexpr const char* kWhat[] = {kPairs, kFeatures, kScene};
    const auto what = what_.of(std::span<const char* const>(kWhat), text);
    plan(what.size());
    for (const char* const one : what) {
      step(one, [&] {
        if (one == kPairs) measure_pairs();
        if (one == kFeatures) add_feature_impacts(results, pairs_, rounds_, continuous_.seed);
        if (one == kScene) measure_scene();
      });
    }
    print("impacts", {"ns", "over_distance", "pairs", "hits", "missed", "late", "loose",
                      "median_gap", "worst_gap"});
    print("feature_impacts");
    print("swept_scenes");
  }
  void measure_pairs() {
    const auto kinds = kinds_.of(pair_kinds(), [](const PairKind& kind) { return kind.name; });
    const auto turns = turns_.of(std::span<const PairTurn>(kPairTurns),
                                 [](PairTurn turn) { return to_text(turn); });
    for (const PairKind& kind : kinds) {
      for (const PairTurn turn : turns) {
        add_impacts(results, {.kind = kind,
                              .turn = turn,
                              .pairs = pairs_,
                              .rounds = rounds_,
                              .peers = peers_,
                              .seed = continuous_.seed});
      }
    }
  }
  void measure_scene() {
    if (continuous_.fast > continuous_.bodies) throw ArgumentError("--fast: more than --bodies");
    continuous_.frames = rounds_;
    add_continuous_collision(results, continuous_);
  }

  Chosen what_{{"all"}};
  Chosen kinds_{{"all"}};
  Chosen turns_{{"all"}};
  std::size_t pairs_ = 2048;
  std::size_t rounds_ = 7;
  bool peers_ = true;
  ContinuousRaceOptions continuous_;
};

class Kernels final : public RowsCommand {
 public:
  void add_options(CLI::App& app) {
    option(app, "--kernel", text_, "Only kernels whose names contain this text");
    number(app, "--rounds", rounds_, 1, 1000,
           "Number of rounds; all contenders take turns in each");
    add_rows_options(app);
  }

 private:
  void measure() override {
    plan(1);
    step("kernels", [&] { add_kernels(results, rounds_, text_); });
    print("kernels");
  }

  std::string text_;
  std::size_t rounds_ = 9;
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
      command<Filters>(app, "filters",
                       "Measures the cost of layers and masks for pairs, rays and boxes: each "
                       "query and the same query of a partition without filters, in turns. Results "
                       "are checked by brute force."),
      command<FootprintCommand>(app, "footprint",
                                "Measures bytes per object by purpose, and checks them against the "
                                "allocated memory and the resident set of the process."),
      command<Queries>(app, "queries",
                       "Measures rays, boxes, frusta, balls, swept volumes and nearest objects on "
                       "one frame of a scene, with partitions and Embree in turns. Results are "
                       "compared hit by hit; \"undecided\" counts queries whose result is within "
                       "the rounding error of Embree's float arithmetic."),
      command<Narrow>(
          app, "narrow",
          "Measures the time per pair of shapes: winnow's tiers and other libraries, in turns, on "
          "the same random pairs. Other libraries start without cached results of earlier calls."),
      command<AccuracyCommand>(
          app, "accuracy",
          "Measures the error and time of pairs of shapes by kind, tier and size ratio, for winnow "
          "and other libraries. Every second pair overlaps, and half of the pairs nearly touch."),
      command<Impacts>(app, "impacts",
                       "Measures times of impact: the time per pair of shapes for winnow and other "
                       "libraries, in turns, on the same motions; missed and late impacts, and the "
                       "remaining gaps; features of meshes; impacts of a scene with some fast "
                       "bodies, compared with its contacts."),
      command<Pipeline>(app, "pipeline",
                        "Measures the time from poses to contacts in whole scenes, for winnow and "
                        "other libraries in turns: a pile of 20,000 bodies and 2,000 hulls on a "
                        "terrain of 200,978 triangles, each moving slightly (without carry-over) "
                        "and at rest (with carry-over), and two tori of 20,000 triangles."),
      command<Volumes>(app, "volumes",
                       "Compares bounding volumes and margins: false positives and time, including "
                       "the exact test of the pairs."),
      command<Kernels>(app, "kernels",
                       "Measures the kernels of partitions on every instruction set, on cubes that "
                       "stay in the cache.")};
}

}  // namespace winnow::bench
