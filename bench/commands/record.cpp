#include "bench/commands/arguments.h"
#include "bench/commands/command.h"
#include "bench/common/table.h"
#include "bench/recordings/recording.h"

#include <iostream>

namespace winnow::bench {
namespace {

struct Record {
  std::string scene;
  std::string out;
  std::size_t objects = 10'000;
  std::size_t steps = 30;
  std::uint64_t seed = 1;

  [[nodiscard]] int run() const {
    const auto source = scene_or_error(scene, objects, seed);
    write_recording(out, *source, "boxes", steps);
    std::cout << out << ": " << grouped(objects) << " objects, the first frame and "
              << grouped(steps) << " more\n";
    return kDone;
  }
};

}  // namespace

Command add_record(CLI::App& app) {
  auto record = std::make_shared<Record>();
  CLI::App* sub = app.add_subcommand("record", "Writes a built-in scene to an .aabbs file");
  sub->add_option("scene", record->scene, "Its name")->required();
  sub->add_option("--objects", record->objects, "Number of objects")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}))
      ->capture_default_str();
  sub->add_option("--frames", record->steps, "Frames after the first one")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000}))
      ->capture_default_str();
  sub->add_option("--seed", record->seed, "What the scene is drawn from")->capture_default_str();
  sub->add_option("--out", record->out, "The file to write")->required();
  return {sub, [record] { return record->run(); }};
}

}  // namespace winnow::bench
