#include "bench/commands/arguments.h"
#include "bench/commands/rows_run.h"
#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/measure/resident_set.h"
#include "bench/rows/memory_rows.h"

namespace winnow::bench {
namespace {

struct FootprintCommand {
  Choice choice;
  std::string json;

  int run();
};

int FootprintCommand::run() {
  choose_isa(choice.isa);
  if (choice.scenes.empty()) choice.scenes = {"uniform"};
  if (choice.objects.empty()) choice.objects = {10'000, 100'000};
  if (choice.threads.empty()) choice.threads = {usual_threads().back()};
  const std::vector<NamedScene> scenes = named_scenes(choice.scenes);
  RowsRun run(choice.objects.size() * scenes.size() * choice.threads.size());
  declare_memory(run.results());
  keep_resident_set_exact();
  for (const std::size_t asked : choice.objects) {
    for (const NamedScene& scene : scenes) {
      if (scene.is_recording() && asked != choice.objects.front()) continue;
      const std::size_t objects = scene.objects(asked);
      const std::vector<std::string> partitions = partitions_for(choice.partitions, objects).taken;
      for (const int threads : choice.threads) {
        run.step(scene.name + ", " + grouped(objects) + " objects", [&](Results& results) {
          add_footprints(results, scene, objects, choice.seed, partitions, threads);
        });
      }
    }
  }
  run.print("memory", {"bounds", "keys", "client_data", "structure", "scratch", "results",
                       "reserved", "used", "pair_buffer", "exact", "peak_first", "peak_later"});
  run.print("memory_ratio");
  return run.end(json);
}

}  // namespace

Command add_footprint(CLI::App& app) {
  auto command = std::make_shared<FootprintCommand>();
  CLI::App* sub = app.add_subcommand(
      "footprint",
      "Bytes an object by purpose, checked against what was really allocated and against the "
      "process's resident set");
  add_targets_option(*sub, command->choice);
  add_objects_option(*sub, command->choice);
  add_threads_option(*sub, command->choice);
  add_partitions_option(*sub, command->choice);
  add_isa_option(*sub, command->choice);
  add_seed_option(*sub, command->choice);
  add_json_option(*sub, command->json);
  return {sub, [command] { return command->run(); }};
}

}  // namespace winnow::bench
