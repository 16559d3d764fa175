#include "bench/commands/arguments.h"
#include "bench/commands/rows_run.h"
#include "bench/rows/volume_rows.h"

namespace winnow::bench {
namespace {

struct Volumes {
  VolumeQuestion asked;
  std::string scene = "uniform";
  std::string recording;
  std::vector<std::string> settings;
  std::string isa;
  std::string json;

  int run();
};

int Volumes::run() {
  choose_isa(isa);
  asked.scene = named_scenes({recording.empty() ? scene : recording}).front();
  RowsRun run(settings.size());
  declare_volumes(run.results());
  for (const std::string& setting : settings) {
    asked.setting = setting;
    run.step(setting, [&](Results& results) { add_volumes(results, asked); });
  }
  run.print("volumes", {"reported", "overlapping", "false_positives", "make_ms", "broad_ms",
                        "narrow_ms", "sum_ms", "pays_from_ns", "bytes_per_object"});
  return run.end(json);
}

}  // namespace

Command add_volumes(CLI::App& app) {
  auto volumes = std::make_shared<Volumes>();
  const auto names = volume_setting_names();
  const auto partitions = volume_partitions();
  volumes->settings.assign(names.begin(), names.end());
  CLI::App* sub = app.add_subcommand(
      "volumes",
      "Bounding volumes and margins side by side: false positives against what they cost, the "
      "exact test of the pairs included");
  CLI::Option* scene =
      sub->add_option("--scene", volumes->scene, "Built-in scene for the first table")
          ->capture_default_str();
  sub->add_option("--recording", volumes->recording, "The frames of a recording instead")
      ->excludes(scene);
  sub->add_option("--setting", volumes->settings,
                  "Only these: the scene, turned cubes, turned rods, slow turned cubes")
      ->delimiter(',')
      ->check(CLI::IsMember(volumes->settings));
  sub->add_option(
         "--step", volumes->asked.step,
         "How far objects go in a frame, in their mean edges; default: as suits each, and as "
         "recorded")
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--objects", volumes->asked.objects, "How many")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  sub->add_option("--partition", volumes->asked.partition, "Where the volumes are")
      ->check(CLI::IsMember(std::vector<std::string>(partitions.begin(), partitions.end())))
      ->capture_default_str();
  sub->add_option("--frames", volumes->asked.frames, "Frames that are timed")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--seed", volumes->asked.seed, "Of the scenes")->capture_default_str();
  sub->add_option("--isa", volumes->isa, "Instruction set");
  add_json_option(*sub, volumes->json);
  return {sub, [volumes] { return volumes->run(); }};
}

}  // namespace winnow::bench
