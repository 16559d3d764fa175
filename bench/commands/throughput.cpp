#include "bench/commands/arguments.h"
#include "bench/commands/rows_run.h"
#include "bench/common/table.h"
#include "bench/measure/installed_peers.h"
#include "bench/rows/frame_rows.h"
#include "bench/scenes/scene.h"

namespace winnow::bench {
namespace {

struct Throughput {
  Choice choice;
  bool peers = false;
  std::size_t frames = 0;
  std::string json;

  int run();
};

int Throughput::run() {
  choose_isa(choice.isa);
  if (choice.scenes.empty()) choice.scenes = main_scenes();
  if (choice.objects.empty()) choice.objects = {10'000, 100'000};
  if (choice.threads.empty()) choice.threads = usual_threads();
  if (peers && !has_peers()) {
    throw ArgumentError(
        "--peers: this tool was built without other libraries; "
        "bench/run --with-peers installs and builds them");
  }
  const std::vector<NamedScene> scenes = named_scenes(choice.scenes);
  RowsRun run(choice.objects.size() * scenes.size() * choice.threads.size());
  declare_frames(run.results());
  for (const NamedScene& scene : scenes) {
    for (const std::size_t asked : choice.objects) {
      if (scene.is_recording() && asked != choice.objects.front()) continue;
      const std::size_t objects = scene.objects(asked);
      for (const int threads : choice.threads) {
        run.step(scene.name + ", " + grouped(objects) + " objects, " + threads_text(threads),
                 [&](Results& results) {
                   add_frame_race(results, scene,
                                  {.objects = objects,
                                   .seed = choice.seed,
                                   .partitions = choice.partitions,
                                   .threads = {threads},
                                   .peers = peers,
                                   .frames = frames});
                 });
      }
      derive_frames(run.results(), scene.name, objects);
    }
  }
  run.print("throughput", {"frame_ms", "update_ms", "first_ms", "pairs", "pairs_per_s",
                           "bytes_per_object", "frames", "fingerprint"});
  for (const char* table : {"throughput_threads", "throughput_growth", "throughput_skipped"}) {
    run.print(table);
  }
  return run.end(json);
}

}  // namespace

Command add_throughput(CLI::App& app) {
  auto throughput = std::make_shared<Throughput>();
  CLI::App* sub = app.add_subcommand(
      "throughput",
      "Races partitions, and other libraries, frame by frame interleaved: milliseconds and bytes, "
      "and "
      "how time grows with objects and falls with threads; all must find the same pairs");
  add_targets_option(*sub, throughput->choice);
  add_objects_option(*sub, throughput->choice);
  add_threads_option(*sub, throughput->choice);
  add_partitions_option(*sub, throughput->choice);
  add_isa_option(*sub, throughput->choice);
  add_seed_option(*sub, throughput->choice);
  sub->add_flag("--peers", throughput->peers, "Race other libraries too");
  add_frames_option(*sub, throughput->frames);
  add_json_option(*sub, throughput->json);
  return {sub, [throughput] { return throughput->run(); }};
}

}  // namespace winnow::bench
