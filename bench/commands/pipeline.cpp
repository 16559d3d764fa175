#include "bench/commands/arguments.h"
#include "bench/commands/rows_run.h"
#include "bench/rows/scene_rows.h"

#include <memory>

namespace winnow::bench {
namespace {

const std::vector<std::string> kScenes{"pile", "terrain", "tori"};

struct Pipeline {
  Choice choice;
  std::vector<std::string> scenes = kScenes;
  std::vector<std::string> levels{"manifold"};
  std::vector<int> threads{1, 2};
  std::size_t frames = 9;
  std::size_t bodies = 0;
  bool peers = true;
  std::string json;

  int run();

 private:
  void race(const std::string& scene, RowsRun& run) const;
};

/// All are asked for manifolds; winnow alone for less.
void Pipeline::race(const std::string& scene, RowsRun& run) const {
  const std::unique_ptr<BodySet> set = make_pipeline_scene(scene, bodies, choice.seed);
  PipelineMeasureOptions options{.scene = scene,
                                 .threads = threads,
                                 .peers = peers,
                                 .frames = frames,
                                 .set = set.get(),
                                 .bodies = bodies,
                                 .seed = choice.seed,
                                 .machine_clock = false};
  for (const bool resting : {false, true}) {
    options.resting = resting;
    for (const std::string& level : levels) {
      run.step(scene + (resting ? ", at rest" : ", moving a little"), [&](Results& results) {
        if (level == "manifold") {
          add_scene_race(results, options);
        } else {
          add_scene_level(results, options, level);
        }
      });
    }
  }
}

int Pipeline::run() {
  choose_isa(choice.isa);
  RowsRun run(2 * scenes.size() * levels.size());
  declare_scenes(run.results(), true);
  for (const std::string& scene : scenes) {
    if (scene == "tori") {
      run.step(scene, [&](Results& results) { add_tori(results, frames, peers, false); });
    } else {
      race(scene, run);
    }
  }
  for (const char* table :
       {"whole_scenes", "scene_ratios", "scene_levels", "tori", "mesh_builds"}) {
    run.print(table);
  }
  return run.end(json);
}

}  // namespace

Command add_pipeline(CLI::App& app) {
  auto pipeline = std::make_shared<Pipeline>();
  CLI::App* sub = app.add_subcommand(
      "pipeline",
      "Milliseconds from poses to contacts: whole scenes, winnow and other libraries in turns. A "
      "pile of 20,000 bodies, 2,000 hulls on a terrain of 200,978 triangles, each moving a little "
      "(nothing is carried over) and at rest (contacts are); two tori of 20,000 triangles.");
  sub->add_option("--scene", pipeline->scenes, "Which")
      ->delimiter(',')
      ->check(CLI::IsMember(kScenes))
      ->capture_default_str();
  sub->add_option("--level", pipeline->levels, "How much winnow is asked for")
      ->delimiter(',')
      ->check(CLI::IsMember(scene_level_names()))
      ->capture_default_str();
  sub->add_option("--threads", pipeline->threads, "Numbers of threads that winnow takes")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  sub->add_option("--frames", pipeline->frames, "Timed frames")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10'000}))
      ->capture_default_str();
  sub->add_option("--bodies", pipeline->bodies, "Fewer or more of them in pile and terrain")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000}));
  sub->add_flag("!--no-peers", pipeline->peers, "Without other libraries");
  add_isa_option(*sub, pipeline->choice);
  add_seed_option(*sub, pipeline->choice);
  add_json_option(*sub, pipeline->json);
  return {sub, [pipeline] { return pipeline->run(); }};
}

}  // namespace winnow::bench
