#include "bench/commands/arguments.h"
#include "bench/commands/rows_run.h"
#include "bench/common/table.h"
#include "bench/rows/query_rows.h"
#include "bench/scenes/scene.h"

namespace winnow::bench {
namespace {

struct Queries {
  Choice choice;
  std::string scene = "uniform";
  std::string recording;
  std::size_t objects = 100'000;
  int threads = 1;
  std::size_t rays = 100'000;
  std::size_t rounds = 5;
  std::vector<std::string> sets;
  std::string json;

  int run();
};

int Queries::run() {
  choose_isa(choice.isa);
  const NamedScene named = named_scenes({recording.empty() ? scene : recording}).front();
  RowsRun run(1);
  declare_queries(run.results());
  run.step(
      named.name + ", " + grouped(named.objects(objects)) + " objects, " + threads_text(threads),
      [&](Results& results) {
        add_queries(results, named,
                    {.objects = objects,
                     .seed = choice.seed,
                     .partitions = choice.partitions,
                     .threads = threads,
                     .rays = rays,
                     .rounds = rounds,
                     .sets = sets,
                     .peers = true});
      });
  run.print("queries", {"ns", "found", "questions", "wrong", "undecided"});
  return run.end(json);
}

}  // namespace

Command add_queries(CLI::App& app) {
  auto queries = std::make_shared<Queries>();
  CLI::App* sub = app.add_subcommand(
      "queries",
      "Rays, boxes, frusta, balls, sweeps and nearest objects on one frame of a scene: partitions "
      "and Embree in turns. What they find is compared hit by hit; \"undecided\" counts questions "
      "on which Embree's float arithmetic may fall either way.");
  const auto names = question_set_names();
  CLI::Option* scene = sub->add_option("--scene", queries->scene, "A scene, in its first frame")
                           ->check(CLI::IsMember(scene_names()))
                           ->capture_default_str();
  sub->add_option("--recording", queries->recording, "The first frame of a recording instead")
      ->excludes(scene);
  sub->add_option("--objects", queries->objects, "Number of objects of the scene")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}))
      ->capture_default_str();
  add_partitions_option(*sub, queries->choice);
  sub->add_option("--threads", queries->threads, "Threads")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  add_isa_option(*sub, queries->choice);
  sub->add_option("--rays", queries->rays, "Rays of a set; dearer questions are fewer")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}))
      ->capture_default_str();
  sub->add_option("--rounds", queries->rounds, "Rounds in which all take turns")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000}))
      ->capture_default_str();
  sub->add_option("--set", queries->sets, "Only these sets of questions")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
  add_seed_option(*sub, queries->choice);
  add_json_option(*sub, queries->json);
  return {sub, [queries] { return queries->run(); }};
}

}  // namespace winnow::bench
