// The commands `winnow scenes` and `winnow record`, which list and record the built-in scenes.

#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/common/table.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/recordings/recording.h"
#include "bench/scenes/scene.h"

#include <iostream>

namespace winnow::bench {
namespace {

constexpr std::size_t kObjects = 10'000;

double pairs_an_object(std::string_view scene) {
  const auto source = make_scene(scene, kObjects, 1);
  ReferenceSweep sweep(-1);
  sweep.start(source->boxes());
  return static_cast<double>(sweep.pairs().size()) / static_cast<double>(kObjects);
}

void print_scenes() {
  Table table({"scene", "pairs an object", "description"});
  table.flush_left(2);
  for (const SceneInfo& info : scene_infos()) {
    table.add(
        {std::string(info.name), short_number(pairs_an_object(info.name)), std::string(info.what)});
  }
  std::cout << table << "pairs measured in the first frame of " << grouped(kObjects)
            << " objects (N). Unless stated otherwise,\n"
            << "speeds are up to 5 % of the edge per frame and axis; objects are reflected at the "
               "walls.\n";
}

struct Record {
  std::string scene;
  std::string out;
  std::size_t objects = 10'000;
  std::size_t steps = 30;
  std::uint64_t seed = 1;

  void add_options(CLI::App& app) {
    app.add_option("scene", scene, "Name of the scene")->required();
    add_objects_option(app, objects);
    add_frames_option(app, steps, "Number of frames after the first one");
    add_seed_option(app, seed);
    app.add_option("--out", out, "File to write")->required();
  }
  [[nodiscard]] int run() const {
    const auto source = scene_or_error(scene, objects, seed);
    write_recording(out, *source, "boxes", steps);
    std::cout << out << ": " << grouped(objects) << " objects, the first frame and "
              << grouped(steps) << " more\n";
    return kDone;
  }
};

}  // namespace

void add_scenes(CLI::App& app) {
  app.add_subcommand("scenes", "Lists the built-in scenes")->callback(print_scenes);
}

void add_record(CLI::App& app) {
  command<Record>(app, "record", "Writes frames of a built-in scene to an .aabbs file");
}

}  // namespace winnow::bench
